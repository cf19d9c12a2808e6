# Flags of single sources, for speed. The Makefile has the flags of all sources.

# A step, and its row in a table, take nearly all time: `hot`. In double precision `warm` is optimized without the link.
# The others, `cold`, compile with less optimization in half the time.
modules_in = $(notdir $(basename $(filter $(addsuffix /%,$(addprefix src/,$(1))),$(sources))))
in_both    = $(foreach name,release timed,$(patsubst %,$(BUILD)/$(name)/%.o,$(1)))
for_speed  = $(if $(filter double,$(KIND)),$(call in_both,$(1)))
hot  := document_texts $(filter-out picture% animation canvas drawing svg circuit% set_circuits ranges dwells, \
   $(call modules_in,base linear mechanism blocks continuation perturbed proof rows answers $(if $(filter single,$(KIND)),,results)))
warm := $(if $(filter double,$(KIND)),$(call modules_in,structure assemblies dense lanes))
$(call in_both,$(filter-out $(hot) $(warm),$(modules) $(command))): private extra := $(no_lto) -O$(or $(level_$(KIND)),0)
$(call in_both,$(warm)): private extra := $(no_lto)
# Loops over lanes have few turns: these flags save a tenth of a step.
$(call for_speed,$(call modules_in,lanes)): private extra += -ftree-loop-vectorize -fvect-cost-model=very-cheap -fpeel-loops -fno-tree-loop-distribute-patterns
# Procedures of a step and of a row have few callers: they are inlined at any length. Loops over a few numbers call nothing.
$(call for_speed,$(call modules_in,blocks continuation) number_format masked_numbers listing_tables listing): \
   private extra += -fno-tree-loop-distribute-patterns --param=max-inline-insns-auto=100 --param=large-function-growth=1000 --param=inline-min-speedup=5
