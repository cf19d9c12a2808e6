# KINMAT. make: build/kinmat    make run: the paper's example    make test: unit tests and make check
SHELL := /bin/sh
ifeq ($(origin FC),default)
   FC := gfortran
endif
# The kind of every real: double, single, or quad, a reference that needs no LAPACK. Each has a directory of its own:
# make KIND=quad builds build/quad/kinmat.
KIND   ?= double
BUILD  ?= build$(if $(filter-out double,$(KIND)),/$(KIND))
PREFIX ?= /usr/local
LIBS   ?= -lklu $(if $(filter-out quad,$(KIND)),-llapack -lblas)

# No flag here changes a result: no fast-math, no contraction into fused multiply-add.
# gfortran's "uninitialized" is wrong on every array allocated by assignment.
COMMON  := -std=f2018 -Wall -Wextra -pedantic -Wno-uninitialized -Wno-maybe-uninitialized -ffp-contract=off
RELEASE ?= -O2 $(if $(filter double,$(KIND)),-flto=auto)
DEBUG   ?= -O0 -g -fbacktrace -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow -finit-real=snan -finit-derived

sources := $(sort $(wildcard src/*.f90 src/$(KIND)/*.f90))
names   := $(basename $(notdir $(sources)))
modules := $(filter-out main,$(names))

.PHONY: all kinds run test check forms errors kind-check quad-check single-check bench bench-short hard hard-short study study-short study-1987 digits fuzz fuzz-short expected install install-kinds clean
all: $(BUILD)/kinmat

run: $(BUILD)/kinmat
	$(BUILD)/kinmat input/yoke.deck

# Two builds of the same sources, each in its own directory: release for use, debug for the unit tests.
define build_in
$(BUILD)/$(1)/%.o: src/%.f90 | $(BUILD)/$(1)
	$$(FC) $$(COMMON) $(2) -Isrc/$$(KIND) -J$(BUILD)/$(1) -c -o $$@ $$<
$(BUILD)/$(1)/%.o: src/$(KIND)/%.f90 | $(BUILD)/$(1)
	$$(FC) $$(COMMON) $(2) -J$(BUILD)/$(1) -c -o $$@ $$<
$(BUILD)/$(1)/kinds.o: src/$(KIND)/wp.inc
$(BUILD)/$(1)/libkinmat.a: $(modules:%=$(BUILD)/$(1)/%.o)
	rm -f $$@
	$$(AR) cr $$@ $$^
$(BUILD)/$(1)/kinmat: $(BUILD)/$(1)/main.o $(BUILD)/$(1)/libkinmat.a
	$$(FC) $$(COMMON) $(2) -o $$@ $$^ $$(LIBS)
$(BUILD)/$(1):
	mkdir -p $$@
endef
$(eval $(call build_in,release,$$(RELEASE)))
$(eval $(call build_in,debug,$$(DEBUG)))

# The debug build with the sanitizers, for `make fuzz`.
SANITIZE ?= -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined
$(eval $(call build_in,fuzz,$$(DEBUG) $$(SANITIZE)))

$(BUILD)/kinmat: $(BUILD)/release/kinmat
	cp $< $@

# Beside kinmat, in double precision, kinmat-quad and kinmat-single.
kinds: $(BUILD)/kinmat $(BUILD)/kinmat-quad $(BUILD)/kinmat-single

$(BUILD)/kinmat-quad $(BUILD)/kinmat-single: $(BUILD)/kinmat-%: always
	$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* $(BUILD)/$*/kinmat
	cmp -s $(BUILD)/$*/kinmat $@ || cp $(BUILD)/$*/kinmat $@
.PHONY: always

# Who uses whom, read off the use statements.
$(BUILD)/depends.mk: $(sources)
	@mkdir -p $(BUILD)
	@awk -v names='$(names)' -v build='$(BUILD)' ' \
	   BEGIN { n = split(names, list, " "); for (i = 1; i <= n; i++) ours[list[i]] = 1 } \
	   tolower($$1) == "use" { name = $$2; sub(/,.*/, "", name); \
	      if (name in ours) { file = FILENAME; sub(/^.*\//, "", file); sub(/\.f90$$/, "", file); \
	         print build "/release/" file ".o: " build "/release/" name ".o"; \
	         print build "/debug/" file ".o: " build "/debug/" name ".o"; \
	         print build "/fuzz/" file ".o: " build "/fuzz/" name ".o" } }' $(sources) > $@
ifneq ($(MAKECMDGOALS),clean)
include $(BUILD)/depends.mk
endif

# Closed forms in real128 print the listings that the program must print, byte for byte.
forms := $(addprefix tests/,deck_tally.f90 quad_jet.f90 closed_forms_dyads.f90 closed_forms_linkages.f90 \
   closed_forms_sliders.f90 closed_forms_legs.f90 closed_forms_sixbars.f90 closed_forms_robots.f90 closed_forms_bars.f90 \
   closed_forms_slides.f90 closed_forms_overconstrained.f90 closed_forms_hard.f90 closed_forms_branches.f90 \
   closed_forms.f90 hand_groups.f90)
decks := $(sort $(wildcard input/*.deck))
references := $(decks:input/%.deck=$(BUILD)/expected/%.lst)

$(BUILD)/print_expected: $(forms) tests/print_expected.f90 $(BUILD)/release/libkinmat.a
	mkdir -p $(BUILD)/forms
	$(FC) $(COMMON) $(RELEASE) -J$(BUILD)/forms -I$(BUILD)/release -o $@ $^ $(LIBS)

$(BUILD)/expected/%.lst: input/%.deck $(BUILD)/print_expected
	@mkdir -p $(BUILD)/expected
	$(BUILD)/print_expected $< > $@.new && mv $@.new $@

expected: $(references)
	cp $(references) expected/

# The closed forms against the decks: closure, velocities and accelerations of every pair and drive, in real128.
$(BUILD)/check_forms: $(forms) tests/quad_decks.f90 tests/check_forms.f90 $(BUILD)/release/libkinmat.a
	mkdir -p $(BUILD)/forms
	$(FC) $(COMMON) $(RELEASE) -J$(BUILD)/forms -I$(BUILD)/release -o $@ $^ $(LIBS)

forms: $(BUILD)/check_forms
	$(BUILD)/check_forms $(decks)

# The program's own estimates of its errors against the closed forms.
$(BUILD)/error_estimates: $(forms) tests/error_estimates.f90 $(BUILD)/release/libkinmat.a
	mkdir -p $(BUILD)/errors
	$(FC) $(COMMON) $(RELEASE) -J$(BUILD)/errors -I$(BUILD)/release -o $@ $^ $(LIBS)

errors: $(BUILD)/error_estimates
	$(BUILD)/error_estimates $(decks)

check: $(BUILD)/kinmat $(references)
	BUILD=$(BUILD) tests/check.sh

# The results of a build against the closed forms in real128, at the level of its kind.
kind_sources := $(addprefix tests/,jet_drives.f90 jet_closure.f90 jet_condition.f90 csv_rows.f90 csv_closure.f90 \
   fifty_digits.f90 kind_errors.f90)
$(BUILD)/kind_errors: $(forms) $(kind_sources) $(BUILD)/release/libkinmat.a
	mkdir -p $(BUILD)/forms
	$(FC) $(COMMON) $(RELEASE) -J$(BUILD)/forms -I$(BUILD)/release -o $@ $^ $(LIBS)

kind-check: $(BUILD)/kinmat $(BUILD)/kind_errors
	BUILD=$(BUILD) KIND=$(KIND) tests/kind.sh

quad-check single-check: %-check:
	$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* kind-check

# Speed against the closed forms, and the results of the methods compared; bench-short looks at no clock.
bench_parts := tests/fast_forms.f90 tests/bench_tools.f90 tests/bench_chains.f90 tests/bench_scenes.f90 \
   tests/bench_timing.f90 tests/bench_results.f90 tests/bench_tables.f90 tests/bench_whole.f90 tests/bench.f90

$(BUILD)/bench/bench: $(forms) $(bench_parts) $(BUILD)/release/libkinmat.a
	mkdir -p $(BUILD)/bench
	$(FC) $(COMMON) $(RELEASE) -J$(BUILD)/bench -I$(BUILD)/release -o $@ $^ $(LIBS)

bench: $(BUILD)/kinmat $(BUILD)/bench/bench
	BUILD=$(BUILD) tests/bench.sh

bench-short: $(BUILD)/bench/bench
	BUILD=$(BUILD) tests/bench.sh short

# The method of 1987, measured: tables on standard output, pictures/matrix_1987.png drawn anew (gnuplot-nox).
study_parts := tests/quad_closure.f90 tests/quad_matrices.f90 tests/quad_frozen.f90 tests/sample_mechanisms.f90 tests/scenes_1987.f90 \
   tests/iteration_1987.f90 tests/rates_1987.f90 tests/fast_forms.f90 tests/bench_tools.f90 tests/bench_chains.f90 \
   tests/bench_scenes.f90 tests/bench_timing.f90 tests/runs_1987.f90 tests/matrix_1987.f90

$(BUILD)/study/matrix_1987: $(forms) $(study_parts) $(BUILD)/release/libkinmat.a
	mkdir -p $(BUILD)/study
	$(FC) $(COMMON) $(RELEASE) -J$(BUILD)/study -I$(BUILD)/release -o $@ $^ $(LIBS)

study-1987: $(BUILD)/study/matrix_1987
	$< tables
	OPENBLAS_NUM_THREADS=1 $< times
	$< picture > $(BUILD)/study/matrix_1987.txt
	mkdir -p pictures
	gnuplot -e "numbers='$(BUILD)/study/matrix_1987.txt'; picture='pictures/matrix_1987.png'" tests/matrix_1987.gp

# Accuracy where it is hard to have, in units of what the condition allows; hard-short in fewer instants.
hard_parts := tests/sample_mechanisms.f90 tests/jet_drives.f90 tests/jet_closure.f90 tests/hard_closure.f90 \
   tests/hard_condition.f90 tests/hard_chain.f90 tests/hard_scenes.f90 tests/hard.f90
$(BUILD)/hard/hard: $(forms) $(hard_parts) $(BUILD)/release/libkinmat.a
	mkdir -p $(BUILD)/hard
	$(FC) $(COMMON) $(RELEASE) -J$(BUILD)/hard -I$(BUILD)/release -o $@ $^ $(LIBS)

hard: $(BUILD)/hard/hard
	BUILD=$(BUILD) tests/hard.sh full

hard-short: $(BUILD)/hard/hard
	BUILD=$(BUILD) tests/hard.sh short

# Speed against error of six scenes: kinmat --study for each, times beside the closed forms where there are such, and
# pictures/speed_against_error.png and .svg drawn anew (gnuplot-nox).
$(BUILD)/study/study_ratio: $(forms) tests/fast_forms.f90 tests/bench_tools.f90 tests/bench_chains.f90 tests/bench_scenes.f90 \
   tests/bench_timing.f90 tests/study_ratio.f90 $(BUILD)/release/libkinmat.a
	mkdir -p $(BUILD)/study
	$(FC) $(COMMON) $(RELEASE) -J$(BUILD)/study -I$(BUILD)/release -o $@ $^ $(LIBS)

study: kinds $(BUILD)/study/study_ratio
	BUILD=$(BUILD) tests/study.sh

# Speed against error of one small deck: what must be so whatever the clock says.
study-short: kinds $(BUILD)/debug/kinmat
	OPENBLAS_NUM_THREADS=1 BUILD=$(BUILD) tests/study_short.sh

# Numbers as they are printed against the formats of the run-time library; make digits NUMBERS=... for more of them.
NUMBERS ?= 20000000
$(BUILD)/compare_digits: tests/compare_digits.f90 $(BUILD)/release/libkinmat.a
	$(FC) $(COMMON) $(RELEASE) -I$(BUILD)/release -o $@ $^

digits: $(BUILD)/compare_digits
	$(BUILD)/compare_digits $(NUMBERS)

# Decks made by chance: FUZZ of them, from seed FUZZ_FIRST on.
FUZZ       ?= 100000
FUZZ_FIRST ?= 1
fuzz_sources := $(addprefix tests/,quad_jet.f90 dice.f90 deck_draft.f90 deck_changes.f90 drive_mutations.f90 deck_surplus.f90 \
   deck_mutations.f90 deck_damage.f90 jet_drives.f90 jet_closure.f90 jet_condition.f90 csv_rows.f90 csv_closure.f90 \
   csv_twice.f90 listing_check.f90 fuzz.f90)
$(BUILD)/fuzz/fuzz: $(fuzz_sources) $(BUILD)/fuzz/libkinmat.a
	mkdir -p $(BUILD)/fuzz/tests
	$(FC) $(COMMON) $(DEBUG) $(SANITIZE) -J$(BUILD)/fuzz/tests -I$(BUILD)/fuzz -o $@ $^ $(LIBS)

fuzz: $(BUILD)/fuzz/fuzz
	BUILD=$(BUILD) tests/fuzz.sh $(FUZZ) $(FUZZ_FIRST)

fuzz-short: $(BUILD)/fuzz/fuzz
	BUILD=$(BUILD) tests/fuzz.sh 1000

TEST_LIB     := $(BUILD)/debug/libkinmat.a
TEST_MODULES := $(BUILD)/debug
TEST_FLAGS   := $(COMMON) $(DEBUG)
TEST_LIBS    := $(LIBS)
TEST_HELPERS := $(forms) $(addprefix tests/,deck_samples.f90 sample_mechanisms.f90 quad_closure.f90 quad_matrices.f90 quad_frozen.f90 motion_errors.f90 dice.f90 \
   random_drafts.f90 random_mechanisms.f90 compare_engines.f90 quad_blocks.f90 sample_overconstrained.f90 \
   jet_drives.f90 jet_closure.f90 hard_closure.f90 hard_condition.f90)
include tests/tests.mk

test: $(BUILD)/kinmat $(BUILD)/debug/kinmat $(BUILD)/check_forms $(BUILD)/error_estimates $(BUILD)/compare_digits $(BUILD)/fuzz/fuzz $(BUILD)/hard/hard $(BUILD)/study/matrix_1987 $(references) $(BUILD)/tests$(if $(PFUNIT_DIR),/pfunit)/unit
	BUILD=$(BUILD) MAKE='$(MAKE)' tests/run.sh

install: $(BUILD)/kinmat
	install -d $(DESTDIR)$(PREFIX)/bin
	install -m 755 $(BUILD)/kinmat $(DESTDIR)$(PREFIX)/bin/kinmat

install-kinds: install kinds
	install -m 755 $(BUILD)/kinmat-quad $(BUILD)/kinmat-single $(DESTDIR)$(PREFIX)/bin

clean:
	rm -rf $(BUILD)
