# The man page of kinmat, of the text that `kinmat --help` prints. Options stand in columns 3 to 22, what they do from
# column 24 on; the other lines are commands, before the options, and sentences, behind them. version: for its foot.
# `make install` puts its PREFIX in the place of @PREFIX@.
function plain(text) { gsub(/\\/, "\\e", text); gsub(/-/, "\\-", text); return text }
# bold(words): words in bold, those in capitals, which stand for something else, in italics
function bold(words,   n, i, word, text) {
   n = split(plain(words), word, " ")
   for (i = 1; i <= n; i++) text = text (i > 1 ? " " : "") (word[i] ~ /^[][A-Z\/]+$/ ? "\\fI" : "\\fB") word[i] "\\fR"
   return text
}
BEGIN {
   print ".TH KINMAT 1 \"\" \"" version "\" \"User Commands\""
   print ".SH NAME\nkinmat \\- kinematics of planar mechanisms"
   print ".SH SYNOPSIS\n.B kinmat\n[\\fIoptions\\fR] [\\fIDECK\\fR]"
   print ".SH DESCRIPTION"
   print "Finds positions, velocities and accelerations of all links of a planar"
   print "mechanism of any structure, with revolute and prismatic pairs, for the"
   print "motions of its drives that a deck of 80\\-column cards gives."
}
{ head = substr($0, 1, 23); tail = substr($0, 24) }
/^kinmat/ { print ".TP\n" bold(head) "\n" plain(tail); next }
/^  -/ { if (!options++) print ".SH OPTIONS"; print ".TP\n" bold(head) "\n" plain(tail); next }
/^   / { print plain(tail); next }
/^Exit status: / { sub(/^Exit status: /, ""); statuses = " " }
/^Real numbers: / {
   print ".SH EXIT STATUS"
   sub(/[.]$/, "", statuses)
   n = split(statuses, status, ";")
   for (i = 1; i <= n; i++) { split(status[i], word, " "); sub(/^ *[0-9]+ /, "", status[i]); print ".TP\n" word[1] "\n" status[i] }
   print ".PP"
   statuses = ""
}
statuses { statuses = statuses " " plain($0); next }
/^FILE / { print ".PP" }
{ print plain($0) }
END {
   print ".SH SEE ALSO"
   print "The manual, with all cards, messages and formats:"
   print "\\fI@PREFIX@/share/doc/kinmat/docs/manual.md\\fR."
}
