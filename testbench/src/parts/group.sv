// group: all selected axes start in one clock, or none does.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The runner writes the lists of
// ports per axis.
//
//   starts           a start of axes that are there and can start: exactly those start, one clock later
//   refused          any other start: none starts, and it is refused
//   all_or_none      so either no axis starts or all that were requested
//   stops_others     an axis is stopped exactly if another one wants all to stop
//   holds            a feed hold: all axes to be held are held a clock after all of them rest; otherwise none is
//   emergency        an emergency stop of one axis stops all
module group_properties (
    `PORTS
);
    wire [`AXES-1:0] starting = `AXIS_START;
    wire [`AXES-1:0] stopped = `GROUP_STOP;
    wire [`AXES-1:0] held = `HOLD_FEED;

    wire [3:0] there = (4'd1 << `AXES) - 4'd1;
    wire [3:0] can = `CAN_START;
    wire       good = start_axes != 4'd0 & (start_axes & ~there) == 4'd0 & (start_axes & ~can) == 4'd0;

    reg             past_start = 1'b0;
    reg             past_good = 1'b0;
    reg             past_emergency = 1'b0;
    reg [3:0]       past_axes = 4'd0;
    reg [`AXES-1:0] past_wants = 0;
    reg [`AXES-1:0] past_hold = 0;
    reg [`AXES-1:0] past_rests = 0;
    always @(posedge clk) begin
        past_start <= start & !rst;
        past_good <= good;
        past_emergency <= (|`EMERGENCY_STOP) & !rst;
        past_axes <= start_axes;
        past_hold <= rst ? 0 : `FEED_HOLD;
        past_rests <= `RESTS;
        past_wants <= rst ? 0 : `WANTS_GROUP_STOP;
    end

    always @(*) begin
        starts: assert (!(past_start & past_good) | (starting == past_axes[`AXES-1:0] & !start_refused));
        refused: assert (!(past_start & !past_good) | (starting == 0 & start_refused));
        quiet: assert (past_start | (starting == 0 & !start_refused));
        all_or_none: assert (starting == 0 | starting == past_axes[`AXES-1:0]);
        holds: assert (held == ((past_hold & ~past_rests) == 0 ? past_hold : 0));
        emergency: assert (group_emergency_stop == past_emergency);
    end

    wire [`AXES-1:0] others;
    genvar n;
    generate
        for (n = 0; n < `AXES; n = n + 1) begin : axis
            assign others[n] = |(past_wants & ~(1 << n));
        end
    endgenerate
    always @(*) stops_others: assert (stopped == others);

    always @(*) begin
        reach_all: cover (&starting);
        reach_one: cover (starting == 1);
        reach_held: cover (&held);
        reach_refused: cover (start_refused);
    end
endmodule
