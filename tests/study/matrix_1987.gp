# The picture of `make study-1987`: gnuplot -e "numbers='FILE'; picture='FILE.png'" matrix_1987.gp
# Lines: the theory; points: measured. Nothing in it depends on the day or the machine.
set terminal pngcairo size 1080,680 noenhanced font 'sans,11' background '#ffffff'
set output picture
set datafile missing '-'
set multiplot layout 2, 3 margins 0.065, 0.985, 0.16, 0.885 spacing 0.075, 0.15 \
   title 'The iteration of 1987: each error, divided by the one before it' font ',16'

red = '#c03028'
blue = '#1f5fa8'
green = '#2a8a4a'
set style line 1 lw 4 lc rgb '#e9a59c'
set style line 2 lw 3 lc rgb '#909090' dt 3
set style line 3 lw 2 lc rgb blue
set style line 4 lw 1.5 lc rgb '#202020'
set style line 5 lw 2 lc rgb green
array titles[5] = ['yoke, the example of the paper', 'crank-slider', 'four-bar, open', 'four-bar, crossed', "Andrews' mechanism"]

set logscale y
set format y '%g'
set yrange [0.001:10]
set xrange [0:360]
set xtics 90
unset mytics
set grid xtics ytics lc rgb '#e4e4e4'
set xlabel 'crank angle, deg' offset 0, 0.4
set ylabel 'rate; below 1 it converges' offset 1, 0
set key off

do for [i = 1:5] {
   set title titles[i] offset 0, -0.5
   unset label
   if (i == 1) {
      set label 1 'as printed: the matrix is singular' at 180, 3 center tc rgb red
      set label 2 'at every angle' at 180, 1.7 center tc rgb red
   }
   if (i > 1) {
      plot 1 ls 4, numbers index i - 1 using 1:2 with lines ls 1, \
         '' index i - 1 every 2 using 1:4 with lines ls 2, \
         '' index i - 1 using 1:6 with lines ls 3, \
         '' index i - 1 every 10 using 1:3 with points pt 7 ps 0.6 lc rgb red, \
         '' index i - 1 every 10 using 1:7 with points pt 7 ps 0.6 lc rgb blue
   } else {
      plot 1 ls 4, numbers index i - 1 every 2 using 1:4 with lines ls 2, \
         '' index i - 1 using 1:6 with lines ls 3, \
         '' index i - 1 every 10 using 1:7 with points pt 7 ps 0.6 lc rgb blue
   }
}

unset label
set title 'four-bar, open: from 50 to 60 deg' offset 0, -0.5
set yrange [1e-17:10]
set xrange [0:20]
set xtics 5
set format y '1e%T'
set xlabel 'iterations'
set ylabel 'error'
set label 1 'as printed: angles from the x axis' at screen 0.03, 0.03 tc rgb red
set label 2 'nearest zeros at crank angle 0, kept' at screen 0.31, 0.03 tc rgb '#707070'
set label 3 'nearest zeros of each step: METHOD MATRIX' at screen 0.58, 0.03 tc rgb blue
set label 4 'Newton' at screen 0.92, 0.03 tc rgb green
plot numbers index 5 using 1:2 with linespoints lw 2 lc rgb red pt 7 ps 0.5, \
   '' index 5 using 1:3 with linespoints ls 3 pt 7 ps 0.5, \
   '' index 5 using 1:4 with linespoints ls 5 pt 7 ps 0.5
unset multiplot
