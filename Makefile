# One command per job; `make help` lists them. Every job that needs the workspace sets it up first,
# which takes a fraction of a second when nothing changed.

SHELL := /bin/bash
.DEFAULT_GOAL := help
.PHONY: help setup demo run test bench study compare kinematics faults hosts fuzz sanitize soak paper campaign docs test-long lint format lock clean distclean
MAKEFLAGS += --no-print-directory

# The set-up starts with any Python from 3.8 on, and then chooses the one for .venv by itself.
STARTER := $(firstword $(foreach python,python3 python3.12 python3.11,\
    $(shell $(python) -c 'import sys; sys.version_info >= (3, 8) and print("$(python)")' 2>/dev/null)))
WORKSPACE = . .venv/bin/activate && . install/setup.bash
RUN = $(WORKSPACE) && exec .venv/bin/python tools/ros2_run.py

# Test files that run at the same time.
JOBS ?= 2

# Options of `make run` and `make demo`; ARGS goes through as it is.
OPTIONS = $(if $(FORMULATION),--formulation $(FORMULATION)) \
          $(if $(TRANSITION),--transition $(TRANSITION)) \
          $(if $(TORQUE_RATE),--torque-rate $(TORQUE_RATE)) \
          $(if $(DT),--dt $(DT)) \
          $(if $(GENERATORS),--generators $(GENERATORS)) \
          $(if $(RECORD),--record $(RECORD)) \
          $(if $(filter-out 0,$(VIEW)),--view) \
          $(ARGS)

help: ## list the commands
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' Makefile
	@echo
	@echo "  make run SCENARIO=name [FORMULATION=name] [TRANSITION=seconds] [TORQUE_RATE=Nm/s]"
	@echo "           [DT=seconds] [GENERATORS=on|off|both] [RECORD=full] [VIEW=1] [ARGS='more options of the experiment']"
	@echo "  make test ARGS='-k words'   make setup PYTHON=python3.12   make lock UPGRADE=1"

setup: ## make .venv, install the locked packages, build the messages
	@test -n "$(STARTER)" || { echo "set-up: no Python 3.11 or 3.12: sudo apt install python3 python3-venv python3-dev" >&2; exit 1; }
	@$(STARTER) -B -m tools.workspace $(if $(PYTHON),--python "$(PYTHON)") $(if $(filter setup,$(MAKECMDGOALS)),,--quiet)

demo: setup ## the main job: the arm changes its priorities (scenario priority_switching)
	@$(RUN) ghc_sim_bridge experiment --scenario priority_switching $(OPTIONS)

run: setup ## one scenario: SCENARIO=name and the options below
	@test -n "$(SCENARIO)" || { echo "run: say which one: make run SCENARIO=priority_switching" >&2; exit 2; }
	@$(WORKSPACE) && .venv/bin/python -m tools.model_packages "$(SCENARIO)"
	@$(RUN) ghc_sim_bridge experiment --scenario "$(SCENARIO)" $(OPTIONS)

paper: setup ## every experiment of paper and thesis, docs/results.md, docs/mpc_studies.md and docs/gn_qn.md
	@$(if $(ARGS),,$(MAKE) kinematics)
	@$(RUN) ghc_sim_bridge paper $(ARGS)

campaign: setup ## seeded disturbances of the humanoid's scenarios: how many runs stay up (long)
	@$(WORKSPACE) && .venv/bin/python -m tools.model_packages stand_up
	@$(RUN) ghc_sim_bridge campaign $(ARGS)

bench: setup ## time per control step and per plan, round trips per second
	@$(WORKSPACE) && exec .venv/bin/python benchmarks/run.py $(ARGS)

study: setup ## problem sets that test the formulations: ARGS="names --quick --formulation ghc"
	@$(WORKSPACE) && exec .venv/bin/python benchmarks/study.py $(ARGS)

compare: setup ## every formulation on every case, docs/comparison.md: CLUSTER=tcp://... ARGS="--formulation cascade"
	@$(WORKSPACE) && exec .venv/bin/python benchmarks/compare/run.py $(if $(CLUSTER),--cluster "$(CLUSTER)") $(ARGS)

kinematics: setup ## T1 to T20 of gn_qn_2018, docs/gn_qn.md: ARGS="4 5 20 --variant gn_qn"
	@$(WORKSPACE) && exec .venv/bin/python benchmarks/kinematics/run.py $(ARGS)

faults: setup ## faults injected over DDS, docs/reliability.md: ARGS="--quick --only words --runs 3"
	@$(WORKSPACE) && exec .venv/bin/python -m benchmarks.faults.campaign $(ARGS)

hosts: setup ## robot, controller and operator on three hosts over a bad network, docs/reliability.md
	@$(WORKSPACE) && exec .venv/bin/python -m benchmarks.hosts.run $(ARGS)

fuzz: setup ## a million random cases into every parser, codec, loader and transitions (about an hour)
	@$(WORKSPACE) && exec .venv/bin/python -m benchmarks.fuzz.run $(ARGS)

sanitize: setup ## the core's tests and random calls under address and undefined-behavior sanitizers
	@$(WORKSPACE) && exec .venv/bin/python -m tools.sanitize $(ARGS)

soak: setup ## memory of the generator nodes over ten simulated minutes
	@$(WORKSPACE) && exec .venv/bin/python benchmarks/soak/run.py $(ARGS)

docs: setup ## the documents as a static site in build/site, its notebooks executed
	@$(WORKSPACE) && exec .venv/bin/python -m tools.docs

test: setup ## all tests, those that fail once more alone; JOBS=1 for one after the other; ARGS goes to pytest
	@$(WORKSPACE) && .venv/bin/python -m tools.model_packages --all
	@$(WORKSPACE) && exec .venv/bin/python -m tools.run_tests -n $(JOBS) --dist loadfile $(ARGS)

test-long: setup ## what takes too long for every change: whole studies against what is asked
	@$(WORKSPACE) && .venv/bin/python -m tools.model_packages --all
	@$(WORKSPACE) && exec .venv/bin/python -m pytest -m long $(ARGS)

lint: setup ## ruff and mypy
	@$(WORKSPACE) && ruff check && ruff format --check && mypy

format: setup ## put the code into the project's format
	@$(WORKSPACE) && ruff check --fix && ruff format

lock: setup ## write the hash-pinned locks anew (UPGRADE=1: newer versions)
	@$(STARTER) -B -m tools.lock $(if $(filter-out 0,$(UPGRADE)),--upgrade)

clean: ## remove what was built and the results; .venv stays
	rm -f src/ghc_controller/ghc_controller/core/native*.so
	rm -rf build install log results .pytest_cache .mypy_cache .ruff_cache

distclean: clean ## remove .venv as well
	rm -rf .venv
