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
# The tools that tests use read, sort and print numbers with a point.
export LC_ALL := C
# GNU make takes a blank for the end of a name. A relative BUILD does whatever the path of this directory holds.
ifneq ($(words $(BUILD)),1)
   $(error BUILD='$(BUILD)' holds blanks, which make cannot have in names: give one without, or relative to this directory)
endif
# All processors, where the command says nothing of them; a make below another one shares what that has.
ifeq ($(MAKELEVEL),0)
   MAKEFLAGS += -j$(shell nproc 2> /dev/null || echo 1)
endif
LIBS   ?= -lklu -llapack -lblas

# No flag here changes a result: no fast-math, no contraction into fused multiply-add.
# gfortran's "uninitialized" is wrong on every array allocated by assignment.
COMMON  := -std=f2018 -Wall -Wextra -pedantic -Wno-uninitialized -Wno-maybe-uninitialized \
   -ffp-contract=off $(COVERAGE)
# real128 is the library's work, whatever the flags; the other kinds are for comparison, and compile in half the time.
# Two parts at the link are enough for two processors, and have less to exchange than the many of the default.
# Neighbours are not computed in pairs: to load as a pair what was stored one by one takes up to 9 per cent of a step.
# Procedures begin with a line of the processor's cache: otherwise what stands before them decides on up to 8 per cent of a step.
# Position-independent objects serve the command and the shared library; the optimization at link time drops what only the latter needs.
RELEASE ?= $(if $(filter double,$(KIND)),-O2 -fno-tree-vectorize -falign-functions=64 -fPIC -flto=auto --param=lto-partitions=2 -ffat-lto-objects,$(if $(filter quad,$(KIND)),-O0,-O1))
# Links in two seconds what the optimization at link time takes ten for.
no_lto  := -fno-lto -fno-use-linker-plugin
DEBUG   ?= -O0 -g -fbacktrace -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow -finit-real=snan -finit-derived

# A command is told in short, such as `FC blocks/block_state.f90 (debug)`: make V=1 shows it whole, make -s nothing of it.
# $(call say,WORD,FILE,BUILD) stands before a command, $(quiet) before one that says nothing.
quiet    := $(if $(V),,@)
silent    = $(findstring s,$(firstword -$(MAKEFLAGS)))
say       = $(quiet)$(if $(V)$(silent),,echo '$(strip $(1) $(2:src/%=%) $(call in_build,$(filter-out double,$(KIND)) $(filter-out release,$(3))))'; )
in_build  = $(if $(strip $(1)),($(strip $(1))))

# What kinds.F90 and lapack.F90 are told of the kind.
KIND_MACROS := $(if $(filter single,$(KIND)),-DREAL_KIND=real32 -DLETTER=s,$(if $(filter quad,$(KIND)),-DREAL_KIND=real128,-DREAL_KIND=real64 -DLETTER=d))

# Sources are found in the folders of src/ and tests/; the name of a file is that of its module or program. The routines that
# LAPACK lacks for real128 are in tests/: kinmat-quad is a reference, and the only build that uses them.
sources := $(sort $(shell find src -name '*.f90' -o -name '*.F90') $(if $(filter quad,$(KIND)),tests/quad/quad_lapack.f90))
# Text that several modules include, each for its own kind of numbers.
included := $(sort $(shell find src -name '*.inc'))
helpers := $(filter-out $(sources),$(sort $(shell find tests -name '*.f90')))
suites  := $(sort $(shell find tests -name 'test_*.pf'))
# Of the command alone: not in the library.
command := main allocation
# document_texts is made from the documents.
modules := $(filter-out $(command),$(basename $(notdir $(sources)))) document_texts
vpath %.f90 $(sort $(dir $(sources) $(helpers)))
vpath %.F90 $(sort $(dir $(sources)))

.PHONY: all assembly-peers example shared pictures kinds run test check forms errors proofs fool-proofs kind-check quad-check single-check bench bench-short bench-against compare-against bench-peers hard hard-short circuits lengths dwells study study-short study-1987 digits fuzz fuzz-short fuzz-mechanisms fuzz-extremes relations tolerances mutants coverage drawings sizes expected install install-kinds clean
all: $(BUILD)/kinmat

# The paper's example at two instants.
run: $(BUILD)/kinmat
	@$(BUILD)/kinmat docs/first.deck
	@echo ' THE WHOLE MOTION: $(BUILD)/kinmat input/yoke.deck   ITS PICTURE: $(BUILD)/kinmat --no-listing --svg yoke.svg input/yoke.deck'

# Builds of the same sources, each in its own directory: release for use, debug for the unit tests, fuzz with the
# sanitizers for `make fuzz`, timed for programs of tests/ that measure time, optimized at link time as kinmat is.
SANITIZE ?= -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined
release  := $(RELEASE)
debug    := $(DEBUG)
fuzz     := $(DEBUG) $(SANITIZE)
timed    := $(RELEASE)
builds   := release debug fuzz timed
define build_in
$(BUILD)/$(1)/%.o: %.f90 | $(BUILD)/$(1)
	$$(call say,FC,$$<,$(1))$$(FC) $$(COMMON) $$($(1)) -J$(BUILD)/$(1) -c -o $$@ $$<
$(BUILD)/$(1)/%.o: %.F90 | $(BUILD)/$(1)
	$$(call say,FC,$$<,$(1))$$(FC) $$(COMMON) $$($(1)) $$(KIND_MACROS) $$(addprefix -I,$$(sort $$(dir $$(included)))) -J$(BUILD)/$(1) -c -o $$@ $$<
$(BUILD)/$(1)/document_texts.o: $(BUILD)/document_texts.f90 | $(BUILD)/$(1)
	$$(call say,FC,document_texts.f90,$(1))$$(FC) $$(COMMON) $$($(1)) -J$(BUILD)/$(1) -c -o $$@ $$<
$(BUILD)/$(1)/command_line.o: $(BUILD)/$(1)/document_texts.o
$(BUILD)/$(1)/libkinmat.a: $(modules:%=$(BUILD)/$(1)/%.o)
	$$(call say,AR,$$(@F),$(1))rm -f $$@; $$(AR) cr $$@ $$^
$(BUILD)/$(1)/kinmat: $(command:%=$(BUILD)/$(1)/%.o) $(BUILD)/$(1)/libkinmat.a
	$$(call say,LD,$$(@F),$(1))$$(FC) $$(COMMON) $$($(1)) -o $$@ $$^ $$(LIBS)
# The programs of tests/: depends.mk adds the modules of tests/ that each uses.
$(programs:%=$(BUILD)/$(1)/%): $(BUILD)/$(1)/%: $(BUILD)/$(1)/%.o $(BUILD)/$(1)/libkinmat.a
	$$(call say,LD,$$(@F),$(1))$$(FC) $$(COMMON) $$($(1)) $(if $(filter timed,$(1)),,$(no_lto)) -o $$@ $$(filter %.o,$$^) $(BUILD)/$(1)/libkinmat.a $$(LIBS)
$(BUILD)/$(1):
	$$(quiet)mkdir -p $$@
endef

# What the documents say of messages, cards and options, for --explain, --ruler and --help. The file is left alone if nothing has changed in it.
$(BUILD)/document_texts.f90: docs/texts.awk docs/messages.md docs/cards.md docs/command.md
	@mkdir -p $(BUILD)
	@awk -f docs/texts.awk docs/messages.md docs/cards.md docs/command.md > $@.new && if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi

# Who uses whom, read off the use statements.
$(BUILD)/depends.mk: Makefile $(sources) $(helpers) $(suites) tests/depends.awk
	@mkdir -p $(BUILD)
	@awk -v build='$(BUILD)' -v builds='$(builds)' -v included='$(included)' -f tests/depends.awk $(sources) $(helpers) $(suites) > $@.new && mv $@.new $@
ifneq ($(MAKECMDGOALS),clean)
include $(BUILD)/depends.mk
endif
$(foreach build,$(builds),$(eval $(call build_in,$(build))))

# Nearly all time is spent in `hot`: a step, and its row in a table. In double precision `warm` is optimized by itself,
# without the link; the rest and what tests/ has of its own are compiled with less optimization, in half the time.
modules_in = $(notdir $(basename $(filter $(addsuffix /%,$(addprefix src/,$(1))),$(sources))))
hot  := $(filter-out picture% animation canvas drawing svg circuit% set_circuits ranges dwells,\
   $(call modules_in,base linear mechanism blocks continuation perturbed proof rows answers $(if $(filter single,$(KIND)),,results)))
warm := $(if $(filter double,$(KIND)),$(call modules_in,structure assemblies dense lanes))
less := $(patsubst -O2,-O1,$(patsubst -O1,-O0,$(filter -O% -fPIC,$(RELEASE))))
$(patsubst %,$(BUILD)/release/%.o,$(warm)): private release += $(no_lto)
$(patsubst %,$(BUILD)/timed/%.o,$(warm)): private timed += $(no_lto)
# Loops over lanes are of few turns: without counting them, and without calls to copy so little, a step takes a tenth less.
lane_flags := -ftree-loop-vectorize -fvect-cost-model=very-cheap -fpeel-loops -fno-tree-loop-distribute-patterns
lanes := $(if $(filter double,$(KIND)),$(call modules_in,lanes))
$(patsubst %,$(BUILD)/release/%.o,$(lanes)): private release += $(lane_flags)
$(patsubst %,$(BUILD)/timed/%.o,$(lanes)): private timed += $(lane_flags)
# Procedures of a step, and of a row of the listing, are called a few times each: they are put into one another at any length.
step_flags := --param=max-inline-insns-auto=100 --param=large-function-growth=1000 --param=inline-min-speedup=5
step := $(if $(filter double,$(KIND)),$(call modules_in,blocks continuation) numerals known_digits listing_tables listing)
$(patsubst %,$(BUILD)/release/%.o,$(step)): private release += $(step_flags)
$(patsubst %,$(BUILD)/timed/%.o,$(step)): private timed += $(step_flags)
$(patsubst %,$(BUILD)/release/%.o,$(filter-out $(hot) $(warm),$(modules) $(command) $(notdir $(basename $(helpers))))): private release := $(less)
$(patsubst %,$(BUILD)/timed/%.o,$(filter-out $(hot) $(warm),$(modules) $(command))): private timed := $(less)
# The closed forms that `make bench` compares with are compiled as they are fastest, in pairs.
$(BUILD)/timed/fast_forms.o: private timed := $(filter-out -fno-tree-vectorize,$(RELEASE))

$(BUILD)/kinmat: $(BUILD)/release/kinmat
	$(quiet)cp $< $@

# The pictures of the documents, drawn anew.
pictures: $(BUILD)/kinmat
	docs/pictures.sh $< docs/pictures

# The library for C and Python: the eight functions of bindings/kinmat.map, and no other symbol. To optimize it at link
# time takes half a minute, and saves 2.5 per cent of a step.
shared: $(BUILD)/libkinmat.so.2
$(BUILD)/libkinmat.so.2: bindings/kinmat.map $(BUILD)/release/libkinmat.a
	$(call say,LD,$(@F))$(FC) $(COMMON) $(release) $(no_lto) -shared -Wl,--no-undefined -Wl,-soname,$(@F) -Wl,--version-script=$< -Wl,-u,kinmat_read -o $@ $(BUILD)/release/libkinmat.a $(LIBS)

# A program of one's own with the modules.
example: $(BUILD)/example
	$(BUILD)/example

$(BUILD)/example: docs/example.f90 $(BUILD)/release/libkinmat.a
	$(call say,FC,$<)$(FC) $(COMMON) $(release) $(no_lto) -I$(BUILD)/release -o $@ $^ $(LIBS)

# Beside kinmat, in double precision, kinmat-quad and kinmat-single.
kinds: $(BUILD)/kinmat $(BUILD)/kinmat-quad $(BUILD)/kinmat-single

$(BUILD)/kinmat-quad $(BUILD)/kinmat-single: $(BUILD)/kinmat-%: always
	$(quiet)$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* $(BUILD)/$*/kinmat
	$(quiet)cmp -s $(BUILD)/$*/kinmat $@ || cp $(BUILD)/$*/kinmat $@
.PHONY: always

$(BUILD)/quad/release/kind_errors $(BUILD)/single/release/kind_errors: $(BUILD)/%/release/kind_errors: $(BUILD)/kinmat-% always
	$(quiet)$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* $@

# Closed forms in real128 print the listings that the program must print, byte for byte.
decks      := $(sort $(wildcard input/*.deck))
references := $(decks:input/%.deck=$(BUILD)/expected/%.lst)
$(BUILD)/expected/%.lst: input/%.deck $(BUILD)/release/print_expected
	@mkdir -p $(BUILD)/expected
	$(call say,EXPECTED,$<)$(BUILD)/release/print_expected $< > $@.new && mv $@.new $@

expected: $(references)
	cp $(references) expected/

# The closed forms against the decks: closure, velocities and accelerations of every pair and drive, in real128.
forms: $(BUILD)/release/check_forms
	$< $(decks)

# The program's own estimates of its errors against the closed forms.
errors: $(BUILD)/release/error_estimates
	$< $(decks)

# What PROVE proves of them: every step but those of a list, and no bound below the true error.
proofs: $(BUILD)/release/proof_bounds
	$< $(decks)

# Attempts to have something false proved.
fool-proofs: $(BUILD)/release/fool_proofs
	$< 100000

check: $(BUILD)/kinmat $(references)
	BUILD=$(BUILD) tests/system/check.sh

# The results of a build against the closed forms in real128, at the level of its kind.
kind-check: $(BUILD)/kinmat $(BUILD)/release/kind_errors
	BUILD=$(BUILD) KIND=$(KIND) tests/system/kind.sh

quad-check single-check: %-check:
	$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* kind-check

# Speed against the closed forms, and the results of the methods compared; bench-short looks at no clock.
bench: $(BUILD)/timed/bench
	BUILD=$(BUILD) tests/bench/bench.sh

bench-short: $(BUILD)/release/bench
	BUILD=$(BUILD) tests/bench/bench.sh short

# Whole runs of this program against the program at the commit REF: make bench-against REF=HEAD~1
bench-against: $(BUILD)/kinmat
	BUILD=$(BUILD) REF='$(REF)' tests/bench/bench_against.sh

# Answers of this program against those of the program at the commit REF, on N random decks beside those at hand.
compare-against: $(BUILD)/kinmat $(BUILD)/debug/fuzz $(BUILD)/release/fuzz_mechanisms
	BUILD=$(BUILD) REF='$(REF)' N='$(or $(N),3000)' SEED='$(or $(SEED),1)' tests/bench/compare_against.sh

# Time and error of other programs beside this one: they come from the index of Python packages.
bench-peers: $(BUILD)/kinmat $(BUILD)/timed/bench
	BUILD=$(BUILD) tests/bench/peers.sh

# Counts of assemblies by PHCpack, for tests/system/assemblies.sh (Debian's package phcpack): a quarter of an hour.
assembly-peers: $(BUILD)/release/random_blocks
	BUILD=$(BUILD) tests/oracle/assembly_peers.sh 1 100 > tests/validation/assemblies.txt.new
	mv tests/validation/assemblies.txt.new tests/validation/assemblies.txt

# The method of 1987, measured: tables on standard output, docs/matrix_1987.png drawn anew (gnuplot-nox).
study-1987: $(BUILD)/timed/matrix_1987
	$< tables
	OPENBLAS_NUM_THREADS=1 $< times
	$< picture > $(BUILD)/matrix_1987.txt
	mkdir -p docs
	gnuplot -e "numbers='$(BUILD)/matrix_1987.txt'; picture='docs/matrix_1987.png'" tests/study/matrix_1987.gp

# Accuracy where it is hard to have, in units of what the condition allows; hard-short in fewer instants.
hard: $(BUILD)/kinmat $(addprefix $(BUILD)/release/,hard print_expected)
	BUILD=$(BUILD) tests/oracle/hard.sh full

hard-short: $(BUILD)/release/hard
	BUILD=$(BUILD) tests/oracle/hard.sh short

# Circuits of 300 four-bars, crank-sliders and six-bars and of 500 symmetric mechanisms made by chance against closed forms.
circuits: $(addprefix $(BUILD)/release/,circuits_by_chance twins_by_chance)
	$(BUILD)/release/circuits_by_chance
	$(BUILD)/release/twins_by_chance 500

# 300 drawings made by chance with LENGTH cards and axes along bars, against closed forms.
lengths: $(addprefix $(BUILD)/,kinmat release/lengths_by_chance)
	$(BUILD)/release/lengths_by_chance deck 300 | $(BUILD)/kinmat --no-listing --csv - | $(BUILD)/release/lengths_by_chance check 300

# Dwells of 6000 random mechanisms on their dead and change points, against closed forms.
dwells: $(BUILD)/release/dwells_by_chance
	$< 6000

# Speed against error of six scenes: kinmat --study for each, times beside the closed forms where there are such, and
# docs/speed_against_error.png and .svg drawn anew (gnuplot-nox).
study: kinds $(BUILD)/timed/study_ratio
	BUILD=$(BUILD) tests/study/study.sh

# Speed against error of one small deck: what must be so whatever the clock says.
study-short: kinds $(BUILD)/debug/kinmat
	OPENBLAS_NUM_THREADS=1 BUILD=$(BUILD) tests/study/study_short.sh

# Numbers as they are printed against the formats of the run-time library; make digits NUMBERS=... for more of them.
NUMBERS ?= 20000000
digits: $(BUILD)/release/compare_digits
	$< $(NUMBERS)

# Decks made by chance: FUZZ of them, from seed FUZZ_FIRST on.
FUZZ       ?= 100000
FUZZ_FIRST ?= 1
fuzz: $(BUILD)/fuzz/fuzz
	BUILD=$(BUILD) tests/fuzz/fuzz.sh $(FUZZ) $(FUZZ_FIRST)

fuzz-short: $(BUILD)/debug/fuzz
	BUILD=$(BUILD) FUZZ_BUILD=debug tests/fuzz/fuzz.sh 1000

# Mechanisms made by chance, with their motion in real128: N of them, from seed SEED on; all by METHOD, if that is given.
fuzz-mechanisms: $(BUILD)/release/fuzz_mechanisms
	FUZZ_METHOD=$(METHOD) BUILD=$(BUILD) tests/fuzz/fuzz_mechanisms.sh $(or $(N),10000) $(or $(SEED),1)

# Extremes of 3000 laws of RISE and 400 fast cranks against closed forms; of N mechanisms made by chance, from seed SEED on,
# against runs in steps 16 times finer.
fuzz-extremes: $(addprefix $(BUILD)/,kinmat release/extremes_by_chance release/fuzz_mechanisms)
	BUILD=$(BUILD) tests/fuzz/fuzz_extremes.sh --laws 3000 400 $(or $(SEED),1)
	BUILD=$(BUILD) tests/fuzz/fuzz_extremes.sh $(or $(N),200) $(or $(SEED),1)

# Relations between runs of all decks of input/, or of N made by the dice, from seed SEED on; and of runs and assemblies.
relations: $(BUILD)/kinmat $(BUILD)/release/fuzz_mechanisms
	BUILD=$(BUILD) tests/system/relations.sh $(if $(N),--random $(N) $(or $(SEED),1))
	BUILD=$(BUILD) tests/system/assembly_relations.sh $(if $(N),--random $(N) $(or $(SEED),1))

# Tolerances against N decks with all numbers off by chance.
tolerances: $(BUILD)/kinmat $(BUILD)/kinmat-quad
	BUILD=$(BUILD) tests/system/tolerances.sh $(or $(N),10000)

# Faults made by chance in the sources, N=200 of them, one at a time: which do the unit tests and `make check` not see?
mutants: $(BUILD)/release/print_expected
	BUILD=$(BUILD) FC='$(FC)' N='$(N)' SEED='$(SEED)' tests/mutants/mutants.sh

# How many lines of src/ the tests run, file by file.
coverage:
	BUILD=$(BUILD) FC='$(FC)' MAKE='$(MAKE)' tests/coverage.sh

# Drawings of PMKS+ and Linkage in the directory DIR, with positions from elsewhere: make drawings DIR=...
drawings: $(BUILD)/libkinmat.so.2
	LIBKINMAT=$(abspath $<) python3 -B tests/import/drawings.py '$(DIR)'

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
checkers := check_forms error_estimates proof_bounds fool_proofs compare_digits hard matrix_1987 bench fuzz_mechanisms extremes_by_chance read_listing circuits_by_chance twins_by_chance dwells_by_chance lengths_by_chance random_blocks
test: $(addprefix $(BUILD)/,kinmat libkinmat.so.2 example debug/kinmat $(checkers:%=release/%) debug/fuzz kinmat-quad kinmat-single \
   quad/release/kind_errors single/release/kind_errors tests$(if $(PFUNIT_DIR),/pfunit)/unit) $(references)
	BUILD=$(BUILD) MAKE='$(MAKE)' FC='$(FC)' tests/run.sh

# The man page: the text of --help in another form.
$(BUILD)/kinmat.1: $(BUILD)/kinmat docs/man.awk
	$(call say,MAN,$(@F))$< --help | awk -v version="$$($< --version | sed 's/,.*//')" -f docs/man.awk > $@.new && mv $@.new $@

# The command with its man page; the modules and their library: gfortran -I PREFIX/include/kinmat ... -lkinmat; the
# library for C, with its header and what pkg-config reads: gcc ... -lkinmat; kinmat.py, which finds that library; the
# documents, in folders of the same names as here, so that their links lead somewhere, with the decks.
documents := $(DESTDIR)$(PREFIX)/share/doc/kinmat
install: $(BUILD)/kinmat $(BUILD)/kinmat.1 $(BUILD)/libkinmat.so.2
	install -d $(addprefix $(DESTDIR)$(PREFIX)/,bin include/kinmat lib/pkgconfig share/kinmat share/man/man1) $(addprefix $(documents)/,docs/pictures docs/howto input src)
	install -m 755 $(BUILD)/kinmat $(wildcard contrib/kinmat-*) $(DESTDIR)$(PREFIX)/bin
	install -m 644 $(modules:%=$(BUILD)/release/%.mod) $(DESTDIR)$(PREFIX)/include/kinmat
	install -m 644 $(BUILD)/release/libkinmat.a $(DESTDIR)$(PREFIX)/lib
	install -m 755 $(BUILD)/libkinmat.so.2 $(DESTDIR)$(PREFIX)/lib
	install -m 644 bindings/libkinmat.so $(DESTDIR)$(PREFIX)/lib
	install -m 644 bindings/kinmat.h $(DESTDIR)$(PREFIX)/include
	install -m 644 bindings/kinmat.py $(DESTDIR)$(PREFIX)/share/kinmat
	sed -e 's|@PREFIX@|$(PREFIX)|' -e "s|@VERSION@|$$($< --version | sed 's/^KINMAT //; s/,.*//')|" bindings/kinmat.pc.in > $(DESTDIR)$(PREFIX)/lib/pkgconfig/kinmat.pc
	chmod 644 $(DESTDIR)$(PREFIX)/lib/pkgconfig/kinmat.pc
	install -m 644 README.md CHANGELOG.md LICENSE $(documents)
	install -m 644 $(wildcard docs/*.md docs/*.svg docs/*.png) docs/slurm.sh docs/example.f90 docs/example.c docs/plot.gp docs/first.deck $(documents)/docs
	install -m 644 $(wildcard docs/howto/*.md) $(documents)/docs/howto
	install -m 644 $(wildcard docs/pictures/*.svg) $(documents)/docs/pictures
	install -m 644 $(decks) $(documents)/input
	install -m 644 src/README.md $(documents)/src
	sed 's|@PREFIX@|$(PREFIX)|' $(BUILD)/kinmat.1 > $(DESTDIR)$(PREFIX)/share/man/man1/kinmat.1
	chmod 644 $(DESTDIR)$(PREFIX)/share/man/man1/kinmat.1

install-kinds: install kinds
	install -m 755 $(BUILD)/kinmat-quad $(BUILD)/kinmat-single $(DESTDIR)$(PREFIX)/bin

clean:
	rm -rf $(BUILD)
