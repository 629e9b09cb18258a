# What dvsim's jobs do: `build` once, for the simulations that all shards use, and `run` for each shard, whose number is dvsim's seed.
.PHONY: build run
build:
	mkdir -p $(SHARD_FOLDER)
	$(build_cmd) campaign $(build_opts)
run:
	$(run_cmd) campaign $(run_opts) --shard $(seed)/$(SHARDS) --json $(SHARD_FOLDER)/$(seed).json
