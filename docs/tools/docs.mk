# Rules of the documents: their texts inside the program, the man page, pictures, the example of the library.

# Texts of messages, cards and options for --explain, --ruler and --help. An unchanged file keeps its time.
$(BUILD)/document_texts.f90: docs/tools/texts.awk docs/messages.md docs/cards.md docs/command.md
	@mkdir -p $(BUILD)
	@awk -f docs/tools/texts.awk docs/messages.md docs/cards.md docs/command.md > $@.new && if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi
$(builds:%=$(BUILD)/%/command_line.o): $(BUILD)/%/command_line.o: $(BUILD)/%/document_texts.o

# The man page: the text of --help in another form.
$(BUILD)/kinmat.1: $(BUILD)/kinmat docs/tools/man.awk
	$(call say,MAN,$(@F))$< --help | awk -v version="$$($< --version | sed 's/,.*//')" -f docs/tools/man.awk > $@.new && mv $@.new $@

.PHONY: pictures example
#: pictures         draw docs/pictures again
pictures: $(BUILD)/kinmat
	docs/tools/pictures.sh $< docs/pictures

#: example          build and run docs/example.f90
example: $(BUILD)/example
	$(BUILD)/example

$(BUILD)/example: docs/example.f90 $(BUILD)/release/libkinmat.a
	$(call say,FC,$<)$(FC) $(COMMON) $(release) $(no_lto) -I$(BUILD)/release -o $@ $^ $(LIBS)
