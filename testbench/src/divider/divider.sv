// divider: quotient = trunc(steps * T * 2^16 / elapsed), always in the same time.
//
// The properties are proven for all inputs in every clock, including resets, at full size; nothing is assumed. T is TICK_CLOCKS.
//
//   done_after_all     done comes exactly DIVISION_CLOCKS clocks after a start that is taken, and at no other time
//   busy_between       busy from the clock after that start to the one before done; a start is taken unless busy
//   overrun_flagged    a start while busy sets overrun and changes nothing else; set wins over clear_flags
//   quotient_holds     quotient and saturated change with done alone, or to 0 by a reset
//   divided            with done, |steps| * T * 2^16 = whole * divisor + remainder, remainder < divisor; divisor is elapsed, or
//                      T where elapsed is 0
//   quotient_is        and the quotient is whole, with the sign of steps, or +-(2^31 - 1) where whole is larger:
//   saturated_is       saturated says so
//
// So truncation is toward zero on both sides. No product is written with `*`: |steps| * T is the sum of T * 2^k over the set bits
// of |steps|, and whole * divisor the sum 2 (2 (...) + divisor) + ... over the bits of whole, highest first, both kept here.
//   known_...          invariants: what the registers hold in each clock of a division
module divider_properties (
    `PORTS,
    (* peek = "phase" *) input wire [6:0] phase,
    (* peek = "product" *) input wire [34:0] product,
    (* peek = "remainder" *) input wire [23:0] remainder,
    (* peek = "divisor" *) input wire [23:0] divisor,
    (* peek = "negative" *) input wire negative,
    (* peek = "turns_over" *) input wire turns_over,
    (* peek = "too_large" *) input wire too_large,
    (* peek = "downward" *) input wire downward,
    (* peek = "last_pass" *) input wire last_pass,
    (* peek = "fits" *) input wire fits,
    (* peek = "subtracts" *) input wire subtracts
);
    // Clocks since the start that was taken; 0 if none runs, DIVISION_CLOCKS: done.
    reg  [6:0] since = 7'd0;
    wire       runs = since != 7'd0 & since != `DIVISION_CLOCKS;
    wire       taken = start & !runs;
    wire       multiplies = since >= 7'd1 & since <= 7'd18;
    wire       divides = since >= 7'd19 & since <= 7'd69;
    wire       signs = since >= 7'd70 & since <= 7'd101;
    wire [6:0] k = since - 7'd1;
    wire [6:0] d = since - 7'd19;
    wire [6:0] j = since - 7'd70;

    // Operands of the division, and its progress.
    reg  [17:0] size = 18'd0;
    reg         is_negative = 1'b0;
    reg  [23:0] by = 24'd1;
    reg  [34:0] number = 35'd0;
    reg  [34:0] weight = 35'd0;
    reg  [19:0] upper = 20'd0;
    reg  [30:0] lower = 31'd0;
    reg  [51:0] whole_by = 52'd0;
    wire [17:0] size_of_steps = steps < 0 ? -steps : steps;
    always @(posedge clk) begin
        if (rst) since <= 7'd0;
        else if (taken) since <= 7'd1;
        else since <= since == `DIVISION_CLOCKS ? 7'd0 : since == 7'd0 ? 7'd0 : since + 7'd1;
        if (taken & !rst) begin
            size <= size_of_steps;
            is_negative <= steps < 0;
            by <= elapsed == 24'd0 ? `TICK_CLOCKS : elapsed;
            number <= 35'd0;
            weight <= `TICK_CLOCKS;
            upper <= 20'd0;
            lower <= 31'd0;
            whole_by <= 52'd0;
        end else if (multiplies) begin
            number <= number + (size[k] ? weight : 35'd0);
            weight <= weight << 1;
        end else if (divides) begin
            if (d < 7'd20) upper <= {upper[18:0], subtracts};
            else lower <= {lower[29:0], subtracts};
            whole_by <= {whole_by[50:0], 1'b0} + (subtracts ? {28'd0, by} : 52'd0);
        end
    end

    // Invariants of the registers.
    wire [17:0] raw = is_negative ? -size : size;
    wire [17:0] below_k = (18'd1 << k) - 18'd1;
    wire [50:0] dividend = {number, 16'd0};
    wire [50:0] taken_in = dividend >> (7'd51 - d);
    wire [6:0]  kept = d - 7'd20;
    wire [30:0] ones = (31'd1 << kept) - 31'd1;
    wire [30:0] end_or_lower = |upper ? ones : lower;
    wire [30:0] clamped = |upper ? 31'h7fffffff : lower;
    wire [31:0] result = is_negative ? -{1'b0, clamped} : {1'b0, clamped};
    wire [30:0] below_j = (31'd1 << j) - 31'd1;
    always @(*) begin
        known_phase: assert (phase == (runs ? since + 7'd26 : 7'd0) & since <= `DIVISION_CLOCKS);
        known_part: assert (!runs | (downward == !divides & last_pass == signs & fits == (since >= 7'd39)));
        known_operands: assert (by != 24'd0 & (!runs | (divisor == by & negative == is_negative)));
        known_size: assert (!is_negative | (size != 18'd0 & size <= 18'd131072));
        known_size_up: assert (is_negative | size <= 18'd131071);
        known_sum: assert (!multiplies | (product >> (7'd18 - k)) == number);
        known_bits: assert (!multiplies | (product & ((35'd1 << (7'd18 - k)) - 35'd1)) == {17'd0, raw >> k});
        known_weight: assert (!multiplies | weight == {18'd0, `TICK_CLOCKS} << k);
        known_over: assert (!multiplies | turns_over == ((raw & below_k) != 18'd0));
        known_empty: assert (!(multiplies | since == 7'd19) |
            (remainder == 24'd0 & !too_large & upper == 20'd0 & lower == 31'd0 & whole_by == 52'd0));
        known_upper: assert (!divides | d > 7'd20 | (upper >> d) == 20'd0);
        known_zeros: assert (!divides | d > 7'd20 | (lower == 31'd0 & product == number << d));
        known_quotient: assert (!divides | d < 7'd20 | product == ((number << d) | {4'd0, end_or_lower}));
        known_lower: assert (!divides | d < 7'd20 | (lower & ~ones) == 31'd0);
        known_large: assert (!(divides | signs) | too_large == |upper);
        known_remainder: assert (!divides | remainder < by);
        known_division: assert (!divides | {1'b0, whole_by} + {29'd0, remainder} == {2'd0, taken_in});
        known_sign: assert (!signs | product == (({3'd0, result} << (7'd35 - j)) | ({4'd0, clamped} >> j)));
        known_turn: assert (!signs | turns_over == ((clamped & below_j) != 31'd0));
    end

    // Properties of the ports.
    reg  [23:0] left = 24'd0;
    reg         past_reset = 1'b1;
    reg         past_start = 1'b0;
    reg         past_runs = 1'b0;
    reg         past_clear = 1'b0;
    reg         past_overrun = 1'b0;
    reg         past_saturated = 1'b0;
    reg  [31:0] past_quotient = 32'd0;
    always @(posedge clk) begin
        if (since == 7'd70) left <= remainder;
        past_reset <= rst;
        past_start <= start;
        past_runs <= runs;
        past_clear <= clear_flags;
        past_overrun <= overrun;
        past_saturated <= saturated;
        past_quotient <= quotient;
    end
    always @(*) begin
        done_after_all: assert (done == (since == `DIVISION_CLOCKS));
        busy_between: assert (busy == runs);
        overrun_flagged: assert (overrun == (!past_reset & ((past_start & past_runs) | (past_overrun & !past_clear))));
        quotient_holds: assert (done | (past_reset ? quotient == 0 & !saturated
            : quotient == past_quotient & saturated == past_saturated));
        divided_begins: assert (since != 7'd70 | (remainder < by & {1'b0, whole_by} + {29'd0, remainder} == {2'd0, dividend}));
        divided: assert (since < 7'd71 | (left < by & {1'b0, whole_by} + {29'd0, left} == {2'd0, dividend}));
        quotient_is: assert (!done | quotient == result);
        saturated_is: assert (!done | saturated == |upper);
    end

    always @(*) begin
        reach_positive: cover (done & quotient > 32'sd65536);
        reach_negative: cover (done & quotient < -32'sd65536);
        reach_saturated: cover (saturated & is_negative);
        reach_overrun: cover (done & overrun);
        reach_again: cover (done & start);
    end
endmodule
