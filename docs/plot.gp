# Draws a table of KINMAT (--table): positions, velocities and accelerations, lengths on the left and angles on the right.
#    gnuplot -e "table = 'run.csv'" plot.gp                over time, to run.csv.svg
#    gnuplot -e "table = 'run.csv'; over = 2" plot.gp      over the second column, the value of the first drive
if (!exists("over")) over = 1
set datafile separator ","
set terminal svg size 1200,1200 noenhanced background rgb "white"
set output table.".svg"
set style data lines
set key above maxcols 4 samplen 2
set grid
set autoscale xfix
# The numbers of the columns whose names have one of these endings.
columns(endings) = system(sprintf("head -n 1 '%s' | tr , '\n' | grep -nE '[.](%s)$' | cut -d : -f 1 | paste -s -d ' '", table, endings))
set multiplot layout 3,2
do for [endings in "x|y|s phi|theta vx|vy|v vphi|omega ax|ay|a aphi|alpha"] {
   list = columns(endings)
   if (words(list) == 0) { set multiplot next } else {
      plot for [c in list] table using over:(column(int(c))) title columnheader(int(c))
   }
}
unset multiplot
