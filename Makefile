# SPDX-License-Identifier: MIT
# A front door to CMake, so that one word does the whole thing on a machine with nothing but git and make. What is missing is
# installed with apt, as root or through sudo.
#
#   make            build build/release/sagitta
#   make demo       build, render examples/showcase.pbrt to showcase.png
#   make check      build with warnings as errors (gcc and clang), run every test
#   make soak       every random test again with twenty times the rays (SOAK=20), slowly
#   make check-neon the core library for 64-bit ARM under qemu-user: the same bits
#   make lint       formatting, static analysis, the project's own rules
#   make bench      measure building and tracing, beside Embree; BENCH="--help" tells what can be chosen
#   make bench-solids   the same for solids and exact shapes, beside POV-Ray; SOLIDS="--help" tells what can be chosen
#   make gallery    render the pictures of README.md and docs, some of them by NAMES="gallery/lights"; all take an hour on two cores
#   make bench-render   whole pictures beside pbrt-v4's times and pictures; RENDER="--help" tells what can be chosen
#   make install    to PREFIX (/usr/local), below DESTDIR when that is set
#   make deps       only install what all of these need
#   make clean      remove build/

PREFIX ?= /usr/local

all: deps-build
	cmake --preset release
	cmake --build --preset release

deps:
	@scripts/deps.sh build test lint
deps-build:
	@scripts/deps.sh build
deps-test:
	@scripts/deps.sh build test
deps-lint:
	@scripts/deps.sh build test lint

demo: all
	build/release/sagitta render examples/showcase.pbrt -o showcase.png
	@echo "Made showcase.png: every shape, from examples/showcase.pbrt."

check: deps-test build/check build/clang
	cmake --build build/check
	cmake --build build/clang
	@scripts/neon.sh build/neon || [ $$? = 77 ]
	@scripts/run-tests.sh build/check build/clang

# In a build of its own, whose tests may take as long as they like.
SOAK ?= 20
soak: deps-test
	cmake --preset release -B build/soak -DSAGITTA_REQUIRE_TESTS=ON -DSAGITTA_TEST_TIMEOUT=86400 >/dev/null
	cmake --build build/soak
	SAGITTA_SOAK=$(SOAK) ctest --test-dir build/soak -R '^(oracle|unit|isa)/' -j "$$(getconf _NPROCESSORS_ONLN)" --output-on-failure

check-neon:
	@scripts/deps.sh cross || echo "No cross compiler to be had."
	@scripts/neon.sh build/neon || [ $$? = 77 ]

lint: deps-lint build/check build/clang
	cmake --build build/check
	@scripts/lint.sh build/check build/clang

bench: deps-build
	@scripts/deps.sh bench
	@scripts/deps.sh embree || echo "No Embree to be had: measuring Sagitta alone."
	cmake --preset release -DSAGITTA_BENCH=ON
	cmake --build --preset release --target bench-rays
	build/release/bench/bench-rays $(BENCH)

bench-solids: deps-build
	@scripts/deps.sh bench
	@scripts/deps.sh povray || echo "No POV-Ray to be had: measuring Sagitta alone."
	cmake --preset release -DSAGITTA_BENCH=ON
	cmake --build --preset release --target bench-solids
	build/release/bench/bench-solids --compare $(SOLIDS)

bench-render: deps-build
	@scripts/deps.sh bench
	cmake --preset release -DSAGITTA_BENCH=ON
	cmake --build --preset release --target bench-render
	build/release/bench/bench-render $(RENDER)

NAMES ?=
gallery: all
	scripts/gallery.sh $(NAMES)

install: all
	cmake --install build/release --prefix $(PREFIX)

clean:
	rm -rf build showcase.png

# Everything, by gcc and by clang, warnings being errors; the tests run in both.
build/check: FORCE
	@cmake --preset release -B $@ -DSAGITTA_WERROR=ON -DSAGITTA_REQUIRE_TESTS=ON -DSAGITTA_BENCH=ON -DCMAKE_C_COMPILER=gcc -DCMAKE_CXX_COMPILER=g++ >/dev/null
build/clang: FORCE
	@cmake --preset release -B $@ -DSAGITTA_WERROR=ON -DSAGITTA_REQUIRE_TESTS=ON -DSAGITTA_BENCH=ON -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ >/dev/null
FORCE:

.PHONY: all deps deps-build deps-test deps-lint demo check soak check-neon lint bench bench-solids bench-render gallery install clean FORCE
