// segments: a command that is not modulo does not run on past the ends of its position's word.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed of position, velocity or
// acceleration. Any value can be read from the memory.
//
//   phases        a tick is waited for in phase 0 alone, and the last phase is 51
//   range_stops   a move that goes on outwards beyond 2^23 - 2^18 counts: the state stop at once, the entries dropped, and
//                 out_of_range or overflow raised
//   range_only    out_of_range is raised by nothing else, and falls by clear_flags or a reset only
//   stands        a stop that is beyond 2^23 - 2^17 counts outwards at its tick begins with an acceleration of 0
//
// A tick adds less than 2^15 counts: so a move that crosses the first line is a stop before it reaches the second, and a stop that
// crosses the second is 2^17 - 2^15 counts before the end of the word. Not proven here: the sums themselves, and that such a stop
// has a velocity of 0 after its tick: lock step.
module segments_range_properties (
    `PORTS,
    (* peek = "idle" *) input wire idle,
    (* peek = "phase" *) input wire [5:0] phase,
    (* peek = "held_q" *) input wire feed_held,
    (* peek = "u_integrator.decides" *) input wire decides,
    (* peek = "u_integrator.moving" *) input wire moving,
    (* peek = "u_integrator.brakes" *) input wire brakes,
    (* peek = "u_integrator.exact_position" *) input wire [55:0] exact_position,
    (* peek = "u_integrator.exact_velocity" *) input wire [47:0] exact_velocity,
    (* peek = "u_integrator.exact_acceleration" *) input wire [39:0] exact_acceleration
);
    // Counts, and the direction of the command; see docs/segments.md, "End of the position".
    wire signed [23:0] counts = exact_position[55:32];
    wire               outwards = !modulo & (counts < 0) == exact_velocity[47];
    wire               past_reach = outwards & (counts >= `REACH_COUNTS | counts < -`REACH_COUNTS);
    wire               past_stand = outwards & (counts >= `STAND_COUNTS | counts < -`STAND_COUNTS);
    wire               leaves = state == 2'd1 & !feed_held & decides & moving & past_reach;

    reg past_leaves = 1'b0;
    reg past_stands = 1'b0;
    reg past_raised = 1'b0;
    always @(posedge clk) begin
        past_leaves <= leaves & !rst;
        past_stands <= brakes & past_stand & !rst;
        past_raised <= (out_of_range & !clear_flags | leaves) & !rst;
    end
    always @(*) begin
        phases: assert (idle == (phase == 6'd0) & phase <= 6'd51);
        range_stops: assert (!past_leaves | (state == 2'd2 & level == 7'd0 & (out_of_range | overflow)));
        range_only: assert (!out_of_range | past_raised);
        stands: assert (!past_stands | exact_acceleration == 40'd0);
    end

    always @(*) begin
        reach_upper_end: cover (past_stand & !exact_position[55]);
        reach_lower_side: cover (!modulo & counts < -`STAND_COUNTS);
    end
endmodule
