// A cover is what an assert of its opposite would find: with this map the search for counterexamples reaches covers.
(* techmap_celltype = "$cover" *)
module reached (input A, input EN);
    \$assert _TECHMAP_REPLACE_ (.A(!A), .EN(EN));
endmodule
