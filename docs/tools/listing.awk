# An annotated listing as SVG: listing.awk -v notes=FILE LISTING. A line of FILE is a pattern, a tab and a note: the next line of
# the listing that matches is drawn, with its note. A pattern ... stands for lines left out, a blank line for a blank line.
function plain(text) { gsub(/&/, "\\&amp;", text); gsub(/</, "\\&lt;", text); return text }
{ line[++lines] = $0; if (length($0) > width && length($0) < 106) width = length($0) }
END {
   while ((getline note < notes) > 0) {
      split(note "\t", part, "\t")
      text = part[1]
      if (text != "" && text != "...") {
         for (at++; at <= lines && line[at] !~ text; at++) continue
         if (at > lines) { print "listing.awk: no line has " text > "/dev/stderr"; exit 1 }
         text = line[at]
      }
      row[++rows] = text == "..." ? " ..." : text
      what[rows] = part[2]
   }
   side = int(width*6.65) + 40
   printf "<?xml version=\"1.0\" encoding=\"US-ASCII\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\">\n", \
      side + 250, 17*rows + 24, side + 250, 17*rows + 24
   print "<style type=\"text/css\">\ntext{font-family:\"DejaVu Sans Mono\",monospace;font-size:11px;fill:#222;white-space:pre}"
   print "text.note{font-family:\"DejaVu Sans\",Verdana,Arial,sans-serif;font-size:13px;font-style:italic}"
   print "line{stroke:#888;stroke-dasharray:5 4}\n</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>"
   for (i = 1; i <= rows; i++) {
      y = 17*i + 8
      if (row[i] != "") printf "<text x=\"12\" y=\"%d\" xml:space=\"preserve\">%s</text>\n", y, plain(row[i])
      if (what[i] != "") printf "<line x1=\"%d\" y1=\"%d\" x2=\"%d\" y2=\"%d\"/>\n<text class=\"note\" x=\"%d\" y=\"%d\">%s</text>\n", \
         int(length(row[i])*6.65) + 20, y - 4, side - 8, y - 4, side, y, plain(what[i])
   }
   print "</svg>"
}
