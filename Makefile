# SPDX-License-Identifier: GPL-3.0-or-later
# Short names for what the scripts in setup/ and the CMake presets do.
.DEFAULT_GOAL := help
SHELL := bash
.SHELLFLAGS := -euo pipefail -c
.NOTPARALLEL:
.ONESHELL:
.PHONY: help setup setup-test run test test-all test-fast native asan wasm web package test-package bench fuzz lint format clean

help: ## what can be made
	@awk -F ':.*## ' '/^[a-z -]+:.*## / { printf "  make %-16s %s\n", $$1, $$2 }' Makefile

setup: ## install and build what is missing (idempotent)
	@setup/all.sh

setup-test: ## the same, with what only tests need
	@setup/all.sh --test

run: setup ## build, make an example, serve the app and print its address
	@setup/run.sh

test-fast: ## what is quick of it, for every edit
	@setup/test_fast.sh

test: ## everything that a change must pass; ends with "N passed, N failed"
	@setup/test.sh

test-all: ## the same, the crafts' own tests with sanitizers and in WebAssembly, and reliability tests in their long forms
	@setup/test.sh --all

native asan wasm: ## one C++ build: build/, build-asan/ or build-wasm/
	@setup/build.sh $@

web: ## the page, into web/dist/
	@setup/build.sh web

package: setup ## a Debian package for any x86-64 processor, in build-package/
	@setup/package.sh

test-package: package ## install the package in a bare Debian system and run it there (needs root)
	@setup/test_package.sh

bench: ## build natively and run the benchmarks
	@setup/bench.sh

fuzz: ## fuzz the readers, FUZZ_SECONDS=60 each
	@setup/fuzz.sh

lint: ## formatting, static analysis, shell scripts, the page
	@setup/lint.sh

format: ## format the C++ sources in place
	@setup/format.sh

clean: ## remove what was built here; the cache folder stays (docs/toolchain.md)
	rm -rf build build-asan build-wasm build-fuzz build-lint build-package web/dist web/public/wasm
