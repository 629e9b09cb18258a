// cascade: half sums, stage by stage, over rings that share one memory.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. Rings and delays are memories and
// left out: any value can be read from them in every clock. WORD bits, STAGES stages, rings of 2^ADDRESS samples.
//
//   pass_...           a pass takes 2 STAGES + 2 clocks from the strobe that is taken to valid; busy between; a result per pass,
//                      and valid at no other time; the stages come in order, two clocks each: write and read, then add
//   taken              a strobe is taken unless a pass runs, or with a start; else overrun is set, and the pass continues
//   writes_...         in its first clock a stage writes its input, whole, to its own ring at the head; nothing else is written
//   reads_...          it reads what is its own delay before the head, never the word that is being written (a delay is not 0)
//   before_start       what lies before the start, by delay and samples since, is the start value, doubled from stage to stage;
//                      so no word is used that was not written since
//   sum_...            the sum begins with x, and takes the ring's word, or that, once a stage, whole; in a pass nothing else
//                      changes it
//   fits               if the words of the rings lie within 2^k times the ends of x's word in stage k, so does each sum; as these
//                      are what is written to the rings, all of them always do: nothing overflows
//   result_...         y is the sum plus 2^(STAGES - 1), shifted down by STAGES, exact; x after a start; and is constant otherwise
module cascade_properties (
    `PORTS,
    (* peek = "running" *) input wire running,
    (* peek = "adding" *) input wire adding,
    (* peek = "finish" *) input wire finish,
    (* peek = "stage" *) input wire [`INDEX-1:0] stage,
    (* peek = "head" *) input wire [`ADDRESS-1:0] head,
    (* peek = "age" *) input wire [`ADDRESS-1:0] age,
    (* peek = "start_value" *) input wire signed [`WORD-1:0] start_value,
    (* peek = "sum" *) input wire signed [`SUM-1:0] sum,
    (* peek = "earlier" *) input wire signed [`SUM-1:0] earlier,
    (* peek = "before_start" *) input wire before_start,
    (* peek = "u_delays.address" *) input wire [`INDEX-1:0] delay_address,
    (* peek = "u_delays.data" *) input wire [`ADDRESS-1:0] delay,
    (* peek = "u_rings.write_enable" *) input wire write_enable,
    (* peek = "u_rings.write_address" *) input wire [`INDEX+`ADDRESS-1:0] write_address,
    (* peek = "u_rings.write_data" *) input wire signed [`SUM-1:0] write_data,
    (* peek = "u_rings.read_address" *) input wire [`INDEX+`ADDRESS-1:0] read_address,
    (* peek = "u_rings.read_data" *) input wire signed [`SUM-1:0] read_data
);
    localparam [5:0] PASS = `PASS_CLOCKS;
    localparam signed [`SUM:0] ONE = 1;
    localparam signed [`SUM:0] HALF = ONE <<< (`STAGES - 1);

    // Clocks since the strobe that was taken: 0 if none runs.
    reg  [5:0] pass = 6'd0;
    wire       runs = pass != 6'd0 & pass != PASS;
    wire       taken = strobe & (start | !runs);
    wire       of_stage = pass >= 6'd1 & pass <= PASS - 6'd2;
    wire       first = of_stage & pass[0];
    wire       second = of_stage & !pass[0];
    wire [5:0] level = (pass - 6'd1) >> 1;
    always @(posedge clk) begin
        if (rst) pass <= 6'd0;
        else if (taken) pass <= 6'd1;
        else if (start | !runs) pass <= 6'd0;
        else pass <= pass + 6'd1;
    end

    // Samples since the start, up to the longest delay; and the value before it.
    reg        [`ADDRESS-1:0] samples = 0;
    reg signed [`WORD-1:0]    began_at = 0;
    reg        [`ADDRESS-1:0] past_head = 0;
    wire       [`ADDRESS-1:0] samples_before = start ? 0 : samples;
    wire       [`ADDRESS-1:0] head_moved = head - past_head;
    wire       [`ADDRESS-1:0] place_read = head - delay;
    always @(posedge clk) begin
        if (rst) samples <= 0;
        else if (taken) samples <= &samples_before ? samples_before : samples_before + 1'b1;
        else if (start) samples <= 0;
        if (rst) began_at <= 0;
        else if (start) began_at <= x;
    end

    // Values of the previous clock.
    reg                    past_reset = 1'b1;
    reg                    past_taken = 1'b0;
    reg                    past_refused = 1'b0;
    reg                    past_start = 1'b0;
    reg                    past_clear = 1'b0;
    reg                    past_overrun = 1'b0;
    reg                    past_second = 1'b0;
    reg                    past_finish = 1'b0;
    reg                    past_before = 1'b0;
    reg [`INDEX-1:0]       past_delay_address = 0;
    reg signed [`WORD-1:0] past_x = 0;
    reg signed [`WORD-1:0] past_y = 0;
    reg signed [`SUM-1:0]  past_sum = 0;
    reg signed [`SUM-1:0]  past_added = 0;
    wire signed [`SUM-1:0] added = before_start ? earlier : read_data;
    always @(posedge clk) begin
        past_reset <= rst;
        past_taken <= taken;
        past_refused <= strobe & !taken;
        past_start <= start;
        past_clear <= clear_flags;
        past_overrun <= overrun;
        past_second <= second;
        past_finish <= pass == PASS - 6'd1 & !start;
        past_before <= !rst & delay >= samples;
        past_delay_address <= delay_address;
        past_head <= rst ? 0 : head;
        past_x <= x;
        past_y <= y;
        past_sum <= sum;
        past_added <= added;
    end

    always @(*) begin
        pass_known: assert (pass <= PASS);
        pass_valid: assert (valid == (pass == PASS));
        pass_busy: assert (busy == runs);
        pass_stages: assert (running == of_stage & (!running | (adding == second & stage == level)));
        pass_finish: assert (finish == (pass == PASS - 6'd1));
        taken_or_flagged: assert (overrun == (!past_reset & (past_refused | (past_overrun & !past_clear))));
        writes_once: assert (write_enable == first);
        writes_own: assert (!first | (write_address == {level[`INDEX-1:0], head} & write_data == sum));
        reads_own: assert (!first | read_address == {level[`INDEX-1:0], place_read});
        reads_delay: assert (!first | past_delay_address == level[`INDEX-1:0]);
        reads_not_written: assert (!first | delay == 0 | read_address != write_address);
        reads_head: assert (past_reset ? head == 0 : head_moved == past_taken);
        before_known: assert (before_start == past_before & age == samples & start_value == began_at);
        before_value: assert (!of_stage | earlier == began_at <<< level);
        sum_begins: assert (past_reset | !past_taken | sum == past_x);
        sum_adds: assert (past_reset | past_taken | past_start | sum == (past_second ? past_sum + past_added : past_sum));
    end

    // The words that the rings give in this pass are within 2^k times the ends of a word, and so is the sum.
    localparam signed [`SUM:0] LARGEST = (ONE <<< (`WORD - 1)) - ONE;
    localparam signed [`SUM:0] SMALLEST = -(ONE <<< (`WORD - 1));
    reg                  within = 1'b1;
    wire signed [`SUM:0] upper = LARGEST <<< level;
    wire signed [`SUM:0] lower = SMALLEST <<< level;
    wire                 read_fits = read_data >= lower & read_data <= upper;
    always @(posedge clk) within <= rst | taken | (within & (!second | before_start | read_fits));
    always @(*) begin
        fits: assert (!runs | !within | (sum >= lower & sum <= upper));
    end

    // The result.
    reg                  past_within = 1'b0;
    wire signed [`SUM:0] rounded = (past_sum + HALF) >>> `STAGES;
    always @(posedge clk) past_within <= within;
    always @(*) begin
        result: assert (past_reset | !past_finish | !past_within | y == rounded);
        result_of_start: assert (past_reset | !past_start | y == past_x);
        result_holds: assert (past_reset | past_finish | past_start | y == past_y);
    end

    always @(*) begin
        reach_valid: cover (valid);
        reach_memory: cover (valid & within & y != began_at & samples != 1);
        reach_overrun: cover (valid & overrun);
        reach_start: cover (past_start & past_taken & past_y != past_x);
    end
endmodule
