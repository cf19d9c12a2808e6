# KINMAT. make: build/kinmat    make run: the paper's example    make help: all targets
extra :=
FC := $(if $(filter default,$(origin FC)),gfortran,$(FC))
# The kind of every real: double, single, or quad, a reference without LAPACK. make KIND=quad builds build/quad/kinmat.
KIND   ?= double
BUILD  ?= build$(if $(filter-out double,$(KIND)),/$(KIND))
PREFIX ?= /usr/local
LIBS   ?= -lklu -llapack -lblas
$(if $(filter 1,$(words $(BUILD))),,$(error BUILD='$(BUILD)' holds blanks, which make cannot have in names: give one without, or relative to this directory))
# All processors, unless the command or a make above this one decides. Tools read, sort and print numbers with a point.
MAKEFLAGS += $(if $(filter 0,$(MAKELEVEL)),-j$(shell nproc 2> /dev/null || echo 1))
export LC_ALL := C

# No flag here changes a result. gfortran's "uninitialized" is wrong on every array allocated by assignment.
COMMON := -std=f2018 -Wall -Wextra -pedantic -Wno-uninitialized -Wno-maybe-uninitialized -ffp-contract=off $(COVERAGE)
# Each kind: macros of kinds.F90 and lapack.F90, flags, and the level of `cold` files. Only double is for speed.
macros_double  := -DREAL_KIND=real64 -DLETTER=d
macros_single  := -DREAL_KIND=real32 -DLETTER=s
macros_quad    := -DREAL_KIND=real128
# Pairs of stored numbers cost 9 per cent of a step, unaligned procedures 8. Objects serve command and shared library.
release_double := -O2 -fno-tree-vectorize -falign-functions=64 -fPIC -flto=auto --param=lto-partitions=2 -ffat-lto-objects
release_single := -O1
release_quad   := -O0
level_double   := 1
RELEASE ?= $(release_$(KIND))
# Links in two seconds instead of ten.
no_lto  := -fno-lto -fno-use-linker-plugin

# The name of a file is that of its module or program; its folder does not matter. Only quad uses a source of tests/.
sources  := $(sort $(shell find src -name '*.[fF]90') $(if $(filter quad,$(KIND)),tests/quad/quad_lapack.f90))
included := $(sort $(shell find src -name '*.inc'))
# Only the command has these; the library has the other modules.
command  := main allocation
modules  := $(filter-out $(command),$(basename $(notdir $(sources)))) document_texts

# make prints a short line for each command, make V=1 the command, make -s nothing: $(call say,WORD,FILE,BUILD) precedes it.
quiet    := $(if $(V),,@)
note      = $(filter-out double release,$(KIND) $(1))
say       = $(quiet)$(if $(V)$(findstring s,$(firstword -$(MAKEFLAGS))),,echo '$(1) $(2:src/%=%)$(if $(call note,$(3)), ($(call note,$(3))))'; )
# Builds, a directory each, and commands that use the flags of the target's build and those of the file.
builds   := release
release  := $(RELEASE)
build     = $(notdir $(@D))
compile   = $(call say,FC,$<,$(build))$(FC) $(COMMON) $($(build)) $(extra) $(if $(filter %.F90,$<),$(macros_$(KIND)) $(addprefix -I,$(sort $(dir $(included))))) -J$(@D) -c -o $@ $<
link      = $(call say,LD,$(@F),$(build))$(FC) $(COMMON) $($(build)) $(1) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LIBS)

.PHONY: all help run shared kinds install install-kinds clean always

#: all              build the command: build/kinmat
all: $(BUILD)/kinmat
$(BUILD)/kinmat: $(BUILD)/release/kinmat
	$(quiet)cp $< $@

#: help             list the targets
help:
	@sed -n 's/^#: /make /p' Makefile docs/tools/docs.mk tests/tests.mk

#: run              print the paper's example at two instants
run: $(BUILD)/kinmat
	@$(BUILD)/kinmat docs/first.deck
	@echo ' THE WHOLE MOTION: $(BUILD)/kinmat input/yoke.deck   ITS PICTURE: $(BUILD)/kinmat --no-listing --svg yoke.svg input/yoke.deck'

# Tests, their builds, and which object needs which; texts of documents; flags of single sources.
include tests/tests.mk docs/tools/docs.mk src/optimization.mk
# Sources, whose names end in .f90 or .F90.
vpath %90 $(sort $(dir $(sources) $(helpers)) $(BUILD))
define build_in
$(BUILD)/$(1)/%.o: %.f90 | $(BUILD)/$(1); $$(compile)
$(BUILD)/$(1)/%.o: %.F90 | $(BUILD)/$(1); $$(compile)
$(BUILD)/$(1)/libkinmat.a: $(modules:%=$(BUILD)/$(1)/%.o)
	$$(call say,AR,$$(@F),$(1))rm -f $$@; $$(AR) cr $$@ $$^
$(BUILD)/$(1)/kinmat: $(command:%=$(BUILD)/$(1)/%.o) $(BUILD)/$(1)/libkinmat.a
	$$(link)
$(BUILD)/$(1): ; $$(quiet)mkdir -p $$@
endef
$(foreach name,$(builds),$(eval $(call build_in,$(name))))

#: shared           build the library for C and Python: build/libkinmat.so.2
shared: $(BUILD)/libkinmat.so.2
$(BUILD)/libkinmat.so.2: contrib/kinmat.map $(BUILD)/release/libkinmat.a
	$(call say,LD,$(@F))$(FC) $(COMMON) $(release) $(no_lto) -shared -Wl,--no-undefined -Wl,-soname,$(@F) -Wl,--version-script=$< -Wl,-u,kinmat_read -o $@ $(BUILD)/release/libkinmat.a $(LIBS)

#: kinds            build kinmat-quad (real128) and kinmat-single (real32) in addition
kinds: $(BUILD)/kinmat $(BUILD)/kinmat-quad $(BUILD)/kinmat-single
$(BUILD)/kinmat-quad $(BUILD)/kinmat-single: $(BUILD)/kinmat-%: always
	$(quiet)$(MAKE) --no-print-directory KIND=$* BUILD=$(BUILD)/$* $(BUILD)/$*/kinmat
	$(quiet)cmp -s $(BUILD)/$*/kinmat $@ || cp $(BUILD)/$*/kinmat $@

documents := README.md CHANGELOG.md LICENSE src/README.md $(wildcard docs/*.* docs/howto/* docs/pictures/* input/*.deck)
place     := $(DESTDIR)$(PREFIX)
put        = install -D -m $(1) -t $(place)/$(2) $(3)
fill       = install -d $(place)/$(dir $(2)) && sed -e 's|@PREFIX@|$(PREFIX)|' -e "s|@VERSION@|$$($< --version | sed 's/^KINMAT //; s/,.*//')|" $(1) > $(place)/$(2) && chmod 644 $(place)/$(2)
#: install          install command, libraries, documents under PREFIX (/usr/local)
install: $(BUILD)/kinmat $(BUILD)/kinmat.1 $(BUILD)/libkinmat.so.2
	$(call put,755,bin,$(BUILD)/kinmat $(wildcard contrib/kinmat-*))
	$(call put,644,include/kinmat,$(modules:%=$(BUILD)/release/%.mod))
	$(call put,644,include,contrib/kinmat.h)
	$(call put,755,lib,$(BUILD)/libkinmat.so.2)
	$(call put,644,lib,$(BUILD)/release/libkinmat.a contrib/libkinmat.so)
	$(call put,644,share/kinmat,contrib/kinmat.py)
	$(call fill,contrib/kinmat.pc.in,lib/pkgconfig/kinmat.pc)
	$(call fill,$(BUILD)/kinmat.1,share/man/man1/kinmat.1)
	for file in $(documents); do install -D -m 644 $$file $(place)/share/doc/kinmat/$$file || exit 1; done

#: install-kinds    install all three kinds
install-kinds: install kinds
	$(call put,755,bin,$(BUILD)/kinmat-quad $(BUILD)/kinmat-single)

#: clean            remove build/
clean: ; rm -rf $(BUILD)
