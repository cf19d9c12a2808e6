# The picture of `make study`: gnuplot -e "form='png'; numbers='FILE'; scenes='FILE'; picture='FILE'" study.gp
# Time of a step against its error, six blocks of numbers a scene. Nothing in it depends on the day or the machine's name.
if (form eq 'svg') { set terminal svg size 1080,720 noenhanced font 'sans,11' background '#ffffff'
} else { set terminal pngcairo size 1080,720 noenhanced font 'sans,11' background '#ffffff' }
set output picture
set multiplot layout 2, 3 margins 0.065, 0.985, 0.165, 0.885 spacing 0.07, 0.16 \
   title 'Time of a step against its error (position, velocity, acceleration: the largest), tolerance 1E-2 to rounding' font ',14'

red = '#c03028'
blue = '#1f5fa8'
green = '#2a8a4a'
grey = '#707070'
violet = '#8a4fa8'
array titles[6] = ['yoke', 'four-bar', "Andrews' mechanism", "Jansen's leg", 'dead point at 1E-6', '1000 windows']
array closed[6]
stats scenes using 4 every ::0 nooutput
do for [i = 1:6] {
   stats scenes using 4 every ::i-1::i-1 nooutput
   closed[i] = STATS_max
}

set logscale xy
set format x '1e%T'
set format y '%g'
set xrange [1e-17:1]
set xtics 1e-16, 1e4, 1
set grid xtics ytics lc rgb '#e4e4e4'
set xlabel 'largest error' offset 0, 0.4
set ylabel offset 1, 0

unset mxtics
set mytics 1
set key off
set label 11 'blocks (the default)' at screen 0.03, 0.05 tc rgb blue
set label 12 'blocks, 16 times as many steps' at screen 0.20, 0.05 tc rgb '#6fa3dc'
set label 13 'all equations at once' at screen 0.46, 0.05 tc rgb green
set label 14 'matrices of 1987' at screen 0.66, 0.05 tc rgb red
set label 16 'blocks in REAL32' at screen 0.03, 0.018 tc rgb grey
set label 17 'blocks in REAL128, to 1e-30' at screen 0.20, 0.018 tc rgb violet
set label 18 'circle: default tolerance' at screen 0.46, 0.018
# An SVG with a mark at each point would be twice as large.
n = form eq 'svg' ? 2 : 0
clip(x) = x < 2e-17 ? 2e-17 : x

do for [i = 1:6] {
   k = 6*(i - 1)
   set title titles[i] offset 0, -0.5
   set ylabel (closed[i] > 0 ? 'time of the closed form = 1' : 'time of the default = 1')
   set yrange [(closed[i] > 0 ? 1 : 0.3):(closed[i] > 0 ? 2000 : 600)]
   plot numbers index k + 4 using (clip($1)):2 with linespoints pn n lw 1 lc rgb violet pt 7 ps 0.5, \
      '' index k + 3 using (clip($1)):2 with linespoints pn n lw 1 lc rgb grey pt 7 ps 0.5, \
      '' index k + 2 using (clip($1)):2 with linespoints pn n lw 3 lc rgb red pt 7 ps 0.5, \
      '' index k + 1 using (clip($1)):2 with linespoints pn n lw 2 lc rgb green pt 7 ps 0.5, \
      '' index k + 5 using (clip($1)):2 with linespoints pn n lw 1 lc rgb '#6fa3dc' pt 7 ps 0.5, \
      '' index k using (clip($1)):2 with linespoints pn n lw 2 lc rgb blue pt 7 ps 0.5, \
      '' index k using (clip($1)):($3 > 0 ? $2 : NaN) with points pt 6 ps 2 lw 2 lc rgb 'black'
   do for [l = 11:18] { unset label l }
}
unset multiplot
