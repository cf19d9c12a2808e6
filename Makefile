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

.PHONY: all help run shared kinds install install-kinds clean always

#: all              build the command: build/kinmat
all: $(BUILD)/kinmat

#: help             list the targets
help:
	@sed -n 's/^#: /make /p' Makefile docs/tools/docs.mk tests/tests.mk

#: run              print the paper's example at two instants
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
	$$(call say,FC,$$<,$(1))$$(FC) $$(COMMON) $$($(1)) $$(extra) -J$(BUILD)/$(1) -c -o $$@ $$<
$(BUILD)/$(1)/%.o: %.F90 | $(BUILD)/$(1)
	$$(call say,FC,$$<,$(1))$$(FC) $$(COMMON) $$($(1)) $$(extra) $$(KIND_MACROS) $$(addprefix -I,$$(sort $$(dir $$(included)))) -J$(BUILD)/$(1) -c -o $$@ $$<
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
cold := $(filter-out $(hot) $(warm),$(modules) $(command))
in_both = $(foreach build,release timed,$(patsubst %,$(BUILD)/$(build)/%.o,$(1)))
$(call in_both,$(cold)) $(patsubst %,$(BUILD)/release/%.o,$(notdir $(basename $(helpers)))): private extra = $(no_lto) -O$(if $(filter double,$(KIND)),1,0)
$(call in_both,$(warm)): private extra += $(no_lto)
# Loops over lanes are of few turns: without counting them, and without calls to copy so little, a step takes a tenth less.
lanes := $(if $(filter double,$(KIND)),$(call modules_in,lanes))
$(call in_both,$(lanes)): private extra += -ftree-loop-vectorize -fvect-cost-model=very-cheap -fpeel-loops -fno-tree-loop-distribute-patterns
# Procedures of a step, and of a row of the listing, are called a few times each: they are put into one another at any length.
step := $(if $(filter double,$(KIND)),$(call modules_in,blocks continuation) number_format masked_numbers listing_tables listing)
$(call in_both,$(step)): private extra += --param=max-inline-insns-auto=100 --param=large-function-growth=1000 --param=inline-min-speedup=5
$(BUILD)/kinmat: $(BUILD)/release/kinmat
	$(quiet)cp $< $@

#: shared           build the library for C and Python: build/libkinmat.so.2
# The library for C and Python: the eight functions of contrib/kinmat.map, and no other symbol. To optimize it at link
# time takes half a minute, and saves 2.5 per cent of a step.
shared: $(BUILD)/libkinmat.so.2
$(BUILD)/libkinmat.so.2: contrib/kinmat.map $(BUILD)/release/libkinmat.a
	$(call say,LD,$(@F))$(FC) $(COMMON) $(release) $(no_lto) -shared -Wl,--no-undefined -Wl,-soname,$(@F) -Wl,--version-script=$< -Wl,-u,kinmat_read -o $@ $(BUILD)/release/libkinmat.a $(LIBS)

#: kinds            build kinmat-quad (real128) and kinmat-single (real32) in addition
kinds: $(BUILD)/kinmat $(BUILD)/kinmat-quad $(BUILD)/kinmat-single

$(BUILD)/kinmat-quad $(BUILD)/kinmat-single: $(BUILD)/kinmat-%: always
	$(quiet)$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* $(BUILD)/$*/kinmat
	$(quiet)cmp -s $(BUILD)/$*/kinmat $@ || cp $(BUILD)/$*/kinmat $@

decks := $(sort $(wildcard input/*.deck))
include docs/tools/docs.mk tests/tests.mk

# The command with its man page; the modules and their library: gfortran -I PREFIX/include/kinmat ... -lkinmat; the
# library for C, with its header and what pkg-config reads: gcc ... -lkinmat; kinmat.py, which finds that library; the
# documents, in folders of the same names as here, so that their links lead somewhere, with the decks.
documents := $(DESTDIR)$(PREFIX)/share/doc/kinmat
#: install          install command, libraries, documents under PREFIX (/usr/local)
install: $(BUILD)/kinmat $(BUILD)/kinmat.1 $(BUILD)/libkinmat.so.2
	install -d $(addprefix $(DESTDIR)$(PREFIX)/,bin include/kinmat lib/pkgconfig share/kinmat share/man/man1) $(addprefix $(documents)/,docs/pictures docs/howto input src)
	install -m 755 $(BUILD)/kinmat $(wildcard contrib/kinmat-*) $(DESTDIR)$(PREFIX)/bin
	install -m 644 $(modules:%=$(BUILD)/release/%.mod) $(DESTDIR)$(PREFIX)/include/kinmat
	install -m 644 $(BUILD)/release/libkinmat.a $(DESTDIR)$(PREFIX)/lib
	install -m 755 $(BUILD)/libkinmat.so.2 $(DESTDIR)$(PREFIX)/lib
	install -m 644 contrib/libkinmat.so $(DESTDIR)$(PREFIX)/lib
	install -m 644 contrib/kinmat.h $(DESTDIR)$(PREFIX)/include
	install -m 644 contrib/kinmat.py $(DESTDIR)$(PREFIX)/share/kinmat
	sed -e 's|@PREFIX@|$(PREFIX)|' -e "s|@VERSION@|$$($< --version | sed 's/^KINMAT //; s/,.*//')|" contrib/kinmat.pc.in > $(DESTDIR)$(PREFIX)/lib/pkgconfig/kinmat.pc
	chmod 644 $(DESTDIR)$(PREFIX)/lib/pkgconfig/kinmat.pc
	install -m 644 README.md CHANGELOG.md LICENSE $(documents)
	install -m 644 $(wildcard docs/*.md docs/*.svg docs/*.png) docs/slurm.sh docs/example.f90 docs/example.c docs/plot.gp docs/first.deck $(documents)/docs
	install -m 644 $(wildcard docs/howto/*.md) $(documents)/docs/howto
	install -m 644 $(wildcard docs/pictures/*.svg) $(documents)/docs/pictures
	install -m 644 $(decks) $(documents)/input
	install -m 644 src/README.md $(documents)/src
	sed 's|@PREFIX@|$(PREFIX)|' $(BUILD)/kinmat.1 > $(DESTDIR)$(PREFIX)/share/man/man1/kinmat.1
	chmod 644 $(DESTDIR)$(PREFIX)/share/man/man1/kinmat.1

#: install-kinds    install all three kinds
install-kinds: install kinds
	install -m 755 $(BUILD)/kinmat-quad $(BUILD)/kinmat-single $(DESTDIR)$(PREFIX)/bin

#: clean            remove build/
clean:
	rm -rf $(BUILD)
