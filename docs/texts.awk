# The texts of docs/messages.md and docs/cards.md as a Fortran module, for --explain and --ruler. Usage:
# awk -f docs/texts.awk docs/messages.md docs/cards.md. Columns of a message: code, message, cause, cure; of a field of a
# card: card, field, contents, type and range, default, unit. A message keeps the quotation marks ` of its alternatives.
# plain(cell): the cell without the marks of Markdown
function plain(cell,   link) {
   while (match(cell, /\[[^]]*\]\([^)]*\)/)) {
      link = substr(cell, RSTART + 1, RLENGTH - 1); sub(/\]\(.*/, "", link)
      cell = substr(cell, 1, RSTART - 1) link substr(cell, RSTART + RLENGTH)
   }
   gsub(bar, "|", cell)
   return cell
}
# keep(table, row, column, text): another cell, as a case of the table's function, in pieces that fit a line
function keep(table, row, column, text,   lines) {
   if (text == "") return
   gsub(/\047/, "\047\047", text)
   lines = "      case (" 10*row + column ")\n         text = \047"
   while (length(text) > 80) {
      if (!match(substr(text, 1, 80), /.* /)) break
      lines = lines substr(text, 1, RLENGTH) "\047 &\n            //\047"
      text = substr(text, RLENGTH + 1)
   }
   cases[table] = cases[table] lines text "\047\n"
}
# write_table(name, purpose): the function of the table
function write_table(name, purpose) {
   print "\n   !> " purpose "\n   pure function " name "_cell(row, column) result(text)"
   print "      integer, intent(in) :: row, column\n      character(:), allocatable :: text\n"
   print "      select case (10*row + column)"
   printf "%s", cases[name]
   print "      case default\n         text = \047\047\n      end select\n   end function " name "_cell"
}
BEGIN { bar = "\001" }
FNR == 1 { cards = FILENAME ~ /cards[.]md$/ }
/^## / { card = $2 }
/^[|]/ {
   gsub(/\\[|]/, bar)
   cells = split($0, cell, / *[|] */)
   if (!table) {
      # The head: the place of each column that is kept.
      table = !cards && /[|] Message [|]/ ? "message" : cards && /^[|] Field [|] Contents [|]/ ? "field" : "other"
      split("", column)
      for (i = 2; i < cells; i++) if (match(" Code Message Cause Cure ", " " cell[i] " ")) column[i] = cell[i]
      next
   }
   if (/^[|]-/) next
   if (table == "message") {
      messages++
      for (i = 2; i < cells; i++) {
         if (!(i in column)) continue
         text = plain(cell[i])
         if (column[i] != "Message") gsub(/`/, "", text)
         keep(table, messages, column[i] == "Code" ? 1 : column[i] == "Message" ? 2 : column[i] == "Cause" ? 3 : 4, text)
      }
   } else if (table == "field") {
      fields++
      keep(table, fields, 1, card)
      for (i = 2; i < cells; i++) { text = plain(cell[i]); gsub(/`/, "", text); keep(table, fields, i, text) }
   }
   next
}
{ table = "" }
END {
   print "!> Messages and fields of cards as the documents explain them: made by docs/texts.awk from docs/messages.md and"
   print "!> docs/cards.md."
   print "module document_texts\n   implicit none\n   private\n   public :: message_cell, field_cell\n"
   print "   integer, parameter, public :: message_count = " messages ", field_count = " fields "\n\ncontains"
   write_table("message", "A cell of the tables of messages; columns: code, message, cause, cure.")
   write_table("field", "A cell of the tables of cards; columns: card, field, contents, type and range, default, unit.")
   print "end module document_texts"
}
