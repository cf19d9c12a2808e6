# Unit tests: every test_*.pf below TEST_DIR in one program, run by the target `unit`. Its last line is "N passed, N failed".
#
# To be included by the Makefile, or used alone: make -f tests/pfunit/tests.mk TEST_LIB=... unit
#   BUILD         build directory                                               (build)
#   TEST_LIB      objects or archive under test, without the main program       ($(BUILD)/libkinmat.a)
#   TEST_MODULES  directory of their .mod files                                 ($(BUILD))
#   TEST_FLAGS    compiler flags: checks, traps, signalling-NaN fill            (below)
#   TEST_LIBS     libraries to link                                             (-llapack -lblas)
#   TEST_HELPERS  objects of modules that the tests use beside it               (none)
#   TEST_DIR      where the .pf files are, in folders or not                    (tests/unit)
#   TESTS         the .pf files                                                 (test_*.pf below TEST_DIR)
#   PFUNIT_DIR    directory of an installed pFUnit 4; without it the stand-in beside this file serves
# Targets: unit (build and run), unit-build, unit-stand-in (tests of the stand-in itself).

ifeq ($(origin FC),default)
   FC := gfortran
endif
BUILD        ?= build
TEST_LIB     ?= $(BUILD)/libkinmat.a
TEST_MODULES ?= $(BUILD)
TEST_FLAGS   ?= -std=f2018 -Wall -Wextra -pedantic -g -fbacktrace -fcheck=all \
                -ffpe-trap=invalid,zero,overflow -finit-real=snan -finit-derived
TEST_LIBS    ?= -llapack -lblas
TEST_DIR     ?= tests/unit
TESTS        ?= $(sort $(shell find '$(TEST_DIR)' -name 'test_*.pf'))

# What a command says: see the Makefile; alone, nothing but the command.
say        ?=
unit_home  := $(patsubst %/,%,$(dir $(lastword $(MAKEFILE_LIST))))
# Apart, since both bring a module of the name funit.
unit_build := $(BUILD)/tests$(if $(PFUNIT_DIR),/pfunit)
unit_names := $(basename $(notdir $(TESTS)))
# Without the report of array temporaries, which drowns the failures.
unit_flags  = $(TEST_FLAGS) -fcheck=no-array-temps -ffree-line-length-none -J$(unit_build) -I$(TEST_MODULES)

ifneq ($(PFUNIT_DIR),)
   unit_pfunit_mk := $(firstword $(wildcard $(PFUNIT_DIR)/include/PFUNIT.mk $(PFUNIT_DIR)/PFUNIT.mk \
                                            $(PFUNIT_DIR)/PFUNIT-4*/include/PFUNIT.mk))
   ifeq ($(unit_pfunit_mk),)
      $(error PFUNIT_DIR=$(PFUNIT_DIR) holds no include/PFUNIT.mk of pFUnit 4)
   endif
   include $(unit_pfunit_mk)
   unit_flags     += $(PFUNIT_EXTRA_FFLAGS)
   unit_framework :=
   unit_link       = $(PFUNIT_LIBRARIES)
else
   unit_framework := $(unit_build)/funit.o
   unit_link      :=
endif

vpath %.pf $(sort $(dir $(TESTS)))
unit_objects := $(unit_names:%=$(unit_build)/%.o)

.PHONY: unit unit-build unit-stand-in unit-force
unit-build: $(unit_build)/unit

# The tests write their files where the program is: the sources may lie where nothing can be written.
# The program's word is checked, not only its exit status: pFUnit before 4.13 ends with 0 after failures, and a program
# that stops half-way may too. Every @test must have been run.
unit: $(unit_build)/unit
	@status=0; (cd $(unit_build) && exec ./unit) > $(unit_build)/unit.log 2>&1 || status=$$?; \
	expected=`cat $(TESTS) | grep -ci '^[[:blank:]]*@test[[:blank:]]*$$'`; \
	awk -v status=$$status -v expected="$$expected" ' \
	   { print } \
	   /^[0-9]+ passed, [0-9]+ failed$$/ { passed = $$1; failed = $$3; plain = 1; next } \
	   /^ *\([0-9]+ tests?[,)]/ { sub(/^ *\(/, ""); passed = $$1 + 0; failed = 0 } \
	   /^Tests run: / { gsub(/[^0-9]+/, " "); failed = $$2 + $$3; passed = $$1 - failed } \
	   { plain = 0 } \
	   END { \
	      if (passed + failed != expected) { \
	         printf "%d of %d tests were run to their end (exit status %d)\n", passed + failed, expected, status; \
	         failed = expected - passed; plain = 0 \
	      } else if (status && !failed) { \
	         printf "exit status %d\n", status; plain = 0; \
	      } \
	      if (!plain) printf "%d passed, %d failed\n", passed, failed; \
	      exit (status || failed || !passed) \
	   }' $(unit_build)/unit.log

$(unit_build)/unit: $(unit_build)/unit_driver.o $(unit_objects) $(TEST_HELPERS) $(unit_framework) $(TEST_LIB)
	$(call say,LD,$(@F),tests)$(FC) $(TEST_FLAGS) -o $@ $^ $(unit_link) $(TEST_LIBS)

# The list of suites, touched only when it changes: a test file that comes or goes makes the driver anew.
$(unit_build)/suites: unit-force
	@mkdir -p $(@D)
	@echo '$(unit_names)' | cmp -s - $@ || echo '$(unit_names)' > $@

$(unit_objects): $(unit_build)/%.o: $(unit_build)/%.F90 $(TEST_HELPERS) $(unit_framework) $(TEST_LIB)
	$(call say,FC,$(patsubst $(unit_build)/%,%,$<),tests)$(FC) $(unit_flags) -c -o $@ $<

ifneq ($(PFUNIT_DIR),)
# pFUnit reads a copy in the build directory: its preprocessor writes beside the file and reads one line for an annotation.
$(unit_build)/%.pf: %.pf $(unit_home)/pf2f90 | $(unit_build)/suites
	$(quiet)$(unit_home)/pf2f90 --join $< > $@.new && mv $@.new $@

.PRECIOUS: $(unit_build)/%.pf
$(unit_build)/%.F90: $(unit_build)/%.pf
	$(PFUNIT_BIN_DIR)/funitproc -quiet $< $@

$(unit_build)/suites.inc: $(unit_build)/suites
	for name in $(unit_names); do echo "ADD_TEST_SUITE($${name}_suite)"; done > $@

# pFUnit's own source: not held to our standard and warnings.
$(unit_build)/unit_driver.o: $(PFUNIT_INCLUDE_DIR)/driver.F90 $(unit_build)/suites.inc
	$(FC) $(filter-out -std=% -W% -pedantic,$(unit_flags)) -I$(unit_build) -D_TEST_SUITES='"suites.inc"' -c -o $@ $<
else
$(unit_build)/funit.o: $(unit_home)/funit.F90 $(unit_home)/funit_kind.inc | $(unit_build)/suites
	$(call say,FC,$(patsubst $(unit_build)/%,%,$<),tests)$(FC) $(unit_flags) -c -o $@ $<

$(unit_build)/%.F90: %.pf $(unit_home)/pf2f90 | $(unit_build)/suites
	$(quiet)$(unit_home)/pf2f90 $< > $@.new && mv $@.new $@

$(unit_build)/unit_driver.f90: $(unit_build)/suites $(unit_home)/pf2f90
	$(quiet)$(unit_home)/pf2f90 --driver $(unit_names) > $@.new && mv $@.new $@

$(unit_build)/unit_driver.o: $(unit_build)/unit_driver.f90 $(unit_framework)
	$(call say,FC,$(patsubst $(unit_build)/%,%,$<),tests)$(FC) $(unit_flags) -c -o $@ $<
endif

unit-stand-in:
	FC='$(FC)' $(unit_home)/check_stand_in.sh $(BUILD)/stand_in
