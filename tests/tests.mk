# Tests and measurements; `make help` lists them. The Makefile includes this file.
.PHONY: assembly-peers test check forms errors proofs fool-proofs kind-check quad-check single-check bench bench-short bench-against compare-against bench-peers hard hard-short circuits cylinders lengths dwells study study-short study-1987 digits fuzz fuzz-short fuzz-mechanisms fuzz-extremes relations tolerances mutants coverage drawings sizes expected

decks   := $(sort $(wildcard input/*.deck))
helpers := $(filter-out $(sources),$(sort $(shell find tests -name '*.f90')))
suites  := $(sort $(shell find tests -name 'test_*.pf'))
# Builds for tests: with all run-time checks; with sanitizers for `make fuzz`; for programs that measure time, optimized at the
# link as kinmat is.
DEBUG    ?= -O0 -g -fbacktrace -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow -finit-real=snan -finit-derived -DASSERTIONS
SANITIZE ?= -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined
debug    := $(DEBUG)
fuzz     := $(DEBUG) $(SANITIZE)
timed    := $(RELEASE)
builds   += debug fuzz timed
# The rules of the programs of tests/, and which object needs which, from the use statements.
$(BUILD)/depends.mk: Makefile tests/tests.mk $(sources) $(helpers) $(suites) tests/depends.awk
	@mkdir -p $(BUILD)
	@awk -v build='$(BUILD)' -v builds='$(builds)' -v included='$(included)' -f tests/depends.awk $(sources) $(helpers) $(suites) > $@.new && mv $@.new $@
include $(if $(filter-out clean,$(or $(MAKECMDGOALS),all)),$(BUILD)/depends.mk)
$(patsubst %,$(BUILD)/release/%.o,$(notdir $(basename $(helpers)))): private extra := $(no_lto) -O$(or $(level_$(KIND)),0)
# The closed forms that `make bench` compares with are compiled as they are fastest, in pairs.
$(BUILD)/timed/fast_forms.o: private timed := $(filter-out -fno-tree-vectorize,$(RELEASE))

$(BUILD)/quad/release/kind_errors $(BUILD)/single/release/kind_errors: $(BUILD)/%/release/kind_errors: $(BUILD)/kinmat-% always
	$(quiet)$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* $@

# Closed forms in real128 print the listings that the program must print, byte for byte.
references := $(decks:input/%.deck=$(BUILD)/expected/%.lst)
$(BUILD)/expected/%.lst: input/%.deck $(BUILD)/release/print_expected
	@mkdir -p $(BUILD)/expected
	$(call say,EXPECTED,$<)$(BUILD)/release/print_expected $< > $@.new && mv $@.new $@

#: expected         print expected/ again from closed forms
expected: $(references)
	cp $(references) expected/

#: forms            check the closed forms against the decks, in real128
# The closed forms against the decks: closure, velocities and accelerations of every pair and drive, in real128.
forms: $(BUILD)/release/check_forms
	$< $(decks)

#: errors           compare error estimates with true errors
# The program's own estimates of its errors against the closed forms.
errors: $(BUILD)/release/error_estimates
	$< $(decks)

#: proofs           check the bounds of PROVE
# What PROVE proves of them: every step but those of a list, and no bound below the true error.
proofs: $(BUILD)/release/proof_bounds
	$< $(decks)

#: fool-proofs      try to have something false proved
# Attempts to have something false proved.
fool-proofs: $(BUILD)/release/fool_proofs
	$< 100000

#: check            compare the listings of input/ with expected/
check: $(BUILD)/kinmat $(references)
	BUILD=$(BUILD) tests/system/check.sh

#: kind-check       compare this kind with the closed forms
# The results of a build against the closed forms in real128, at the level of its kind.
kind-check: $(BUILD)/kinmat $(BUILD)/release/kind_errors
	BUILD=$(BUILD) KIND=$(KIND) tests/system/kind.sh

#: quad-check       compare kinmat-quad with the closed forms
#: single-check     compare kinmat-single with the closed forms
quad-check single-check: %-check:
	$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* kind-check

#: bench            compare the speed with closed forms
# Speed against the closed forms, and the results of the methods compared; bench-short looks at no clock.
bench: $(BUILD)/timed/bench
	BUILD=$(BUILD) tests/bench/bench.sh

#: bench-short      compare the results of the methods
bench-short: $(BUILD)/release/bench
	BUILD=$(BUILD) tests/bench/bench.sh short

#: bench-against    compare the speed with the program at REF
# Whole runs of this program against the program at the commit REF: make bench-against REF=HEAD~1
bench-against: $(BUILD)/kinmat
	BUILD=$(BUILD) REF='$(REF)' tests/bench/bench_against.sh

#: compare-against  compare the answers on N random decks with the program at REF
# Answers of this program against those of the program at the commit REF, on N random decks beside those at hand.
compare-against: $(BUILD)/kinmat $(BUILD)/debug/fuzz $(BUILD)/release/fuzz_mechanisms
	BUILD=$(BUILD) REF='$(REF)' N='$(or $(N),3000)' SEED='$(or $(SEED),1)' tests/bench/compare_against.sh

#: bench-peers      compare time and error with other programs
# Time and error of other programs beside this one: they come from the index of Python packages.
bench-peers: $(BUILD)/kinmat $(BUILD)/timed/bench
	BUILD=$(BUILD) tests/bench/peers.sh

#: assembly-peers   count assemblies by PHCpack again
# Counts of assemblies by PHCpack, for tests/system/assemblies.sh (Debian's package phcpack): a quarter of an hour.
assembly-peers: $(BUILD)/release/random_blocks
	BUILD=$(BUILD) tests/oracle/assembly_peers.sh 1 100 > tests/validation/assemblies.txt.new
	mv tests/validation/assemblies.txt.new tests/validation/assemblies.txt

#: study-1987       measure the method of 1987
# The method of 1987, measured: tables on standard output, docs/matrix_1987.png drawn anew (gnuplot-nox).
study-1987: $(BUILD)/timed/matrix_1987
	$< tables
	OPENBLAS_NUM_THREADS=1 $< times
	$< picture > $(BUILD)/matrix_1987.txt
	mkdir -p docs
	gnuplot -e "numbers='$(BUILD)/matrix_1987.txt'; picture='docs/matrix_1987.png'" tests/study/matrix_1987.gp

#: hard             measure errors where they are hard to keep small
# Accuracy where it is hard to have, in units of what the condition allows; hard-short in fewer instants.
hard: $(BUILD)/kinmat $(addprefix $(BUILD)/release/,hard print_expected)
	BUILD=$(BUILD) tests/oracle/hard.sh full

#: hard-short       measure such errors at fewer instants
hard-short: $(BUILD)/release/hard
	BUILD=$(BUILD) tests/oracle/hard.sh short

#: circuits         compare circuits of random mechanisms with closed forms
# Circuits of 300 four-bars, crank-sliders and six-bars and of 500 symmetric mechanisms made by chance against closed forms.
circuits: $(addprefix $(BUILD)/release/,circuits_by_chance twins_by_chance)
	$(BUILD)/release/circuits_by_chance
	$(BUILD)/release/twins_by_chance 500

#: cylinders        compare random mechanisms with cylinders with the law of cosines
# 500 booms on cylinders made by chance, with strokes and through the length 0, against the law of cosines.
cylinders: $(addprefix $(BUILD)/,kinmat release/cylinders_by_chance)
	BUILD=$(BUILD) tests/oracle/cylinders.sh 500

#: lengths          compare random drawings with LENGTH with closed forms
# 300 drawings made by chance with LENGTH cards and axes along bars, against closed forms.
lengths: $(addprefix $(BUILD)/,kinmat release/lengths_by_chance)
	$(BUILD)/release/lengths_by_chance deck 300 | $(BUILD)/kinmat --no-listing --csv - | $(BUILD)/release/lengths_by_chance check 300

#: dwells           compare dwells of 6000 random mechanisms with closed forms
# Dwells of 6000 random mechanisms on their dead and change points, against closed forms.
dwells: $(BUILD)/release/dwells_by_chance
	$< 6000

#: study            draw speed against error again
# Speed against error of six scenes: kinmat --study for each, times beside the closed forms where there are such, and
# docs/speed_against_error.png and .svg drawn anew (gnuplot-nox).
study: kinds $(BUILD)/timed/study_ratio
	BUILD=$(BUILD) tests/study/study.sh

#: study-short      check the study of one deck
# Speed against error of one small deck: what must be so whatever the clock says.
study-short: kinds $(BUILD)/debug/kinmat
	OPENBLAS_NUM_THREADS=1 BUILD=$(BUILD) tests/study/study_short.sh

# Numbers as they are printed against the formats of the run-time library; make digits NUMBERS=... for more of them.
NUMBERS ?= 20000000
#: digits           compare printed numbers with the run-time library
digits: $(BUILD)/release/compare_digits
	$< $(NUMBERS)

# Decks made by chance: FUZZ of them, from seed FUZZ_FIRST on.
FUZZ       ?= 100000
FUZZ_FIRST ?= 1
#: fuzz             run FUZZ random decks under sanitizers
fuzz: $(BUILD)/fuzz/fuzz
	BUILD=$(BUILD) tests/fuzz/fuzz.sh $(FUZZ) $(FUZZ_FIRST)

#: fuzz-short       run 1000 random decks
fuzz-short: $(BUILD)/debug/fuzz
	BUILD=$(BUILD) FUZZ_BUILD=debug tests/fuzz/fuzz.sh 1000

#: fuzz-mechanisms  compare N random mechanisms with their motion in real128
# Mechanisms made by chance, with their motion in real128: N of them, from seed SEED on; all by METHOD, if that is given.
fuzz-mechanisms: $(BUILD)/release/fuzz_mechanisms
	FUZZ_METHOD=$(METHOD) BUILD=$(BUILD) tests/fuzz/fuzz_mechanisms.sh $(or $(N),10000) $(or $(SEED),1)

#: fuzz-extremes    compare extremes of random laws and mechanisms
# Extremes of 3000 laws of RISE and 400 fast cranks against closed forms; of N mechanisms made by chance, from seed SEED on,
# against runs in steps 16 times finer.
fuzz-extremes: $(addprefix $(BUILD)/,kinmat release/extremes_by_chance release/fuzz_mechanisms)
	BUILD=$(BUILD) tests/fuzz/fuzz_extremes.sh --laws 3000 400 $(or $(SEED),1)
	BUILD=$(BUILD) tests/fuzz/fuzz_extremes.sh $(or $(N),200) $(or $(SEED),1)

#: relations        compare runs of decks that must agree
# Relations between runs of all decks of input/, or of N made by the dice, from seed SEED on; and of runs and assemblies.
relations: $(BUILD)/kinmat $(BUILD)/release/fuzz_mechanisms $(BUILD)/debug/fuzz
	BUILD=$(BUILD) tests/system/relations.sh $(if $(N),--random $(N) $(or $(SEED),1))
	BUILD=$(BUILD) tests/system/assembly_relations.sh $(if $(N),--random $(N) $(or $(SEED),1))

#: tolerances       compare tolerances with N random decks
# Tolerances against N decks with all numbers off by chance.
tolerances: $(BUILD)/kinmat $(BUILD)/kinmat-quad
	BUILD=$(BUILD) tests/system/tolerances.sh $(or $(N),10000)

#: mutants          count faults in the sources that no test sees
# Faults made by chance in the sources, N=200 of them, one at a time: which do the unit tests and the parts of mutants.sh not see?
mutants: $(addprefix $(BUILD)/,kinmat-quad kinmat-single $(addprefix release/,print_expected cylinders_by_chance fuzz_mechanisms lengths_by_chance random_blocks))
	BUILD=$(BUILD) FC='$(FC)' N='$(N)' SEED='$(SEED)' tests/mutants/mutants.sh

#: coverage         count the lines of src/ that tests run
# How many lines of src/ the tests run, file by file.
coverage:
	BUILD=$(BUILD) FC='$(FC)' MAKE='$(MAKE)' tests/coverage.sh

#: drawings         read the drawings of other programs in DIR
# Drawings of PMKS+ and Linkage in the directory DIR, with positions from elsewhere: make drawings DIR=...
drawings: $(BUILD)/libkinmat.so.2
	LIBKINMAT=$(abspath $<) python3 -B tests/import/drawings.py '$(DIR)'

#: sizes            print the sizes of src/ with their limits
# Lines of code, types, thresholds and names of src/, with their limits.
sizes:
	@awk -v limits=tests/system/sizes.txt -f tests/system/sizes.awk $(sources) $(included)

TEST_LIB     := $(BUILD)/debug/libkinmat.a
TEST_MODULES := $(BUILD)/debug
# Without the tables of a debugger: a failure has its line all the same.
TEST_FLAGS   := $(COMMON) $(filter-out -g,$(DEBUG))
TEST_LIBS    := $(LIBS)
TEST_HELPERS := $(unit_helpers:%=$(BUILD)/debug/%.o)
include tests/pfunit/tests.mk

# What the parts of `make test` need is made beforehand, many at a time; the parts run one after another.
checkers := check_forms error_estimates proof_bounds fool_proofs compare_digits hard matrix_1987 bench fuzz_mechanisms extremes_by_chance read_listing circuits_by_chance twins_by_chance dwells_by_chance lengths_by_chance cylinders_by_chance random_blocks
#: test             run all tests
test: $(addprefix $(BUILD)/,kinmat libkinmat.so.2 example debug/kinmat $(checkers:%=release/%) debug/fuzz kinmat-quad kinmat-single \
   quad/release/kind_errors single/release/kind_errors tests$(if $(PFUNIT_DIR),/pfunit)/unit) $(references)
	BUILD=$(BUILD) MAKE='$(MAKE)' FC='$(FC)' tests/run.sh
