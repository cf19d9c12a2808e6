# The texts of docs/messages.md, docs/cards.md and docs/command.md as a Fortran module, for --explain, --ruler and --help. Usage:
# awk -f docs/tools/texts.awk docs/messages.md docs/cards.md docs/command.md.
# plain(cell): the cell without the marks of Markdown
function plain(cell,   link) {
   while (match(cell, /\[[^]]*\]\([^)]*\)/)) {
      link = substr(cell, RSTART + 1, RLENGTH - 1); sub(/\]\(.*/, "", link)
      cell = substr(cell, 1, RSTART - 1) link substr(cell, RSTART + RLENGTH)
   }
   gsub(bar, "|", cell)
   return cell
}
# folded(head, text, indent): the text behind `head`, in lines of at most 80 columns, the further ones indented
function folded(head, text, indent,   lines, before) {
   lines = head
   before = length(head)
   while (length(text) > 80 - before && match(substr(text, 1, 81 - before), /.* /) && RLENGTH > 1) {
      lines = lines substr(text, 1, RLENGTH - 1) "\n" sprintf("%" indent "s", "")
      text = substr(text, RLENGTH + 1)
      before = indent
   }
   return lines text
}
# padded(text, width): the text with blanks behind it, one at least; '' stays empty
function padded(text, width) { return text == "" ? "" : sprintf("%-" width - 1 "s ", text) }
# keep(table, key, text): a text, as a case of the table's function, in pieces that fit a line
function keep(table, key, text,   lines, line, n, i) {
   if (text == "") return
   gsub(/\047/, "\047\047", text)
   cases[table] = cases[table] "      case (" key ")\n         text = "
   n = split(text, line, "\n")
   for (i = 1; i <= n; i++) {
      lines = lines (i > 1 ? "//nl// &\n            \047" : "\047")
      while (length(line[i]) > 80 && match(substr(line[i], 1, 80), /.* /)) {
         lines = lines substr(line[i], 1, RLENGTH) "\047 &\n            //\047"
         line[i] = substr(line[i], RLENGTH + 1)
      }
      lines = lines line[i] "\047"
   }
   cases[table] = cases[table] lines "\n"
}
# keep_message(): the cells of the message at hand
function keep_message(   codes, message, text) {
   codes = at["Code"]
   message = at["Message"]
   messages++
   gsub(/`/, "", message)
   text = toupper(codes " " message)
   gsub(/[,:;]/, "", text)
   keep("message", 10*messages + 1, text)
   text = folded(padded(codes, 7), message, 7)
   if (at["Cause"] != "") text = text "\n" folded("       CAUSE  ", at["Cause"], 14)
   keep("message", 10*messages + 2, text "\n" folded("       CURE   ", at["Cure"], 14))
}
# write_table(name, arguments, key, otherwise): the function of the table
function write_table(name, arguments, key, otherwise) {
   print "   pure function " name " result(text)\n" arguments "      character(:), allocatable :: text\n"
   print "      select case (" key ")"
   printf "%s", cases[name ~ /^message/ ? "message" : "field"]
   print "      case default\n         text = \047" otherwise "\047\n      end select\n   end function " substr(name, 1, index(name, "(") - 1)
}
BEGIN {
   bar = "\001"
   help = "Usage: kinmat [OPTIONS] [DECK]\nCompute the motion of planar mechanisms from a deck, and print a listing.\n" \
      "Without DECK, or with -, the deck is read from standard input.\nOptions:"
}
FNR == 1 { cards = FILENAME ~ /cards[.]md$/ }
/^## / { card = $2 }
/^[|]/ {
   gsub(/\\[|]/, bar)
   cells = split($0, cell, / *[|] */)
   if (!table) {
      # The head: what each column is.
      table = !cards && /[|] Message [|]/ ? "message" : cards && /^[|] Field [|] Contents [|]/ ? "field" : /^[|] (Option|Status) [|]/ ? "help" : "other"
      if (/^[|] Status /) help = help "\nFILE - is standard output, for one output; the listing gives way to it.\nExit status:"
      for (i = 2; i < cells; i++) column[i] = cell[i]
      next
   }
   if (/^[|]-/) next
   split("", at)
   for (i = 2; i < cells; i++) {
      text = plain(cell[i])
      if (column[i] != "Message") gsub(/`/, "", text)
      at[column[i]] = text
      at[i] = text
   }
   if (table == "message") keep_message()
   else if (table == "help") help = help "\n" folded("  " padded(at[2], 21), at[3], 23)
   else if (table == "field") {
      if (!(card in fields)) names[++fielded] = card
      # Field, contents, type and range, default, unit.
      fields[card] = fields[card] (fields[card] == "" ? "" : "\n") folded(padded(toupper(at[2]), 9), at[3] ": " at[4] \
         (at[5] == "required" ? "; required" : "; default: " at[5]) (at[6] == "" ? "" : "; unit: " at[6]), 9)
   }
   next
}
{ table = "" }
END {
   for (i = 1; i <= fielded; i++) keep("field", "\047" names[i] "\047", fields[names[i]])
   keep("field", "\047\047", help "\nExamples:\n  kinmat four_bar.deck -o four_bar.lst\n" \
      "  kinmat --no-listing --svg four_bar.svg --table four_bar.csv four_bar.deck\n  kinmat --explain E101\n" \
      "Documents: README.md and docs/, installed in PREFIX/share/doc/kinmat, where\n" \
      "PREFIX is /usr/local unless make install was given another.")
   print "!> Messages, fields of cards and options as the documents explain them: made by docs/tools/texts.awk from"
   print "!> docs/messages.md, docs/cards.md and docs/command.md."
   print "module document_texts\n   implicit none\n   private\n   public :: message_cell, help_on\n"
   print "   integer, parameter, public :: message_count = " messages
   print "   character(1), parameter :: nl = new_line(\047a\047)\n\ncontains\n"
   print "   !> A cell of the table of messages: 1 the code and the words of the message, in capitals, without commas and colons; 2"
   print "   !> the lines that explain it."
   write_table("message_cell(row, column)", "      integer, intent(in) :: row, column\n", "10*row + column", "")
   print "\n   !> A line or more for each field of the cards of the name `topic`, in capitals: contents, type, default, unit; for"
   print "   !> the topic \047\047 the text of --help."
   write_table("help_on(topic)", "      character(*), intent(in) :: topic\n", "topic", "This card has no fields.")
   print "end module document_texts"
}
