# Draws a table of KINMAT (--table): positions, velocities and accelerations, lengths on the left and angles on the right.
#    gnuplot -e "table = 'run.csv'" plot.gp                over time, to run.csv.svg
#    gnuplot -e "table = 'run.csv'; over = 2" plot.gp      over the second column, the value of the first drive
# Further variables: name = 'FOUR-BAR' is the title; length = 'MM', angle = 'DEG', time = 'S' are the units.
if (!exists("over")) over = 1
if (!exists("name")) name = table
if (!exists("length")) length = ""
if (!exists("angle")) angle = ""
if (!exists("time")) time = ""
set datafile separator ","
set terminal svg size 1200,1200 noenhanced background rgb "white"
set output table.".svg"
set style data lines
set key above maxcols 4 samplen 2
set grid
set autoscale xfix
colors = "#3b6ea5 #d98324 #4c8c4a #8058a5 #2f9aa0 #96692f #b0528a #7d8c1f #5a6b7b #e07a8b #1f3f7a #c2a83e"
do for [k=1:12] { set linetype k linewidth 1.5 linecolor rgb word(colors, k) }
set linetype cycle 12
# The numbers of the columns whose names have one of these endings and that are not zero throughout.
columns(endings) = system(sprintf("awk -F, 'NR == 1 { for (c = 1; c <= NF; c++) if ($c ~ /[.](%s)$/) list[c] } NR > 1 { for (c in list) if ($c != \"NaN\" && $c + 0 != 0) keep[c] } END { for (c = 1; c <= NF; c++) if (c in keep) printf \"%%d \", c }' '%s'", endings, table))
# A name with its unit, which a power of the unit of time divides; without units the name.
with_unit(what, unit, power) = unit eq "" ? what : what.", ".unit.(power == 0 || time eq "" ? "" : "/".time.(power == 1 ? "" : "**2"))
first_line = system(sprintf("head -n 1 '%s'", table))
heading = system(sprintf("echo '%s' | cut -d , -f %d", first_line, over))
set xlabel over == 1 ? with_unit("t", time, 0) : heading
kinds = "position velocity acceleration"
row = 0
set multiplot layout 3,2 title name
do for [endings in "x|y|s phi|theta vx|vy|v vphi|omega ax|ay|a aphi|alpha"] {
   of_angles = row % 2
   set ylabel with_unit(word(kinds, 1 + row/2), of_angles ? angle : length, row/2)
   list = columns(endings)
   row = row + 1
   if (words(list) == 0) { set multiplot next } else {
      plot for [c in list] table using over:(column(int(c))) title columnheader(int(c))
   }
}
unset multiplot
