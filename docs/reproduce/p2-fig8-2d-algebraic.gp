# y = a (1 + c x^-b)
# gnuplot p2-fig8-2d-algebraic.gp draws p2-fig8-2d-algebraic.svg, p2-fig8-2d-algebraic.pdf and p2-fig8-2d-algebraic.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 560,640 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 6.222222222222222in,7.111111111111111in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 896,1024 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p2-fig8-2d-algebraic.' . kind
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set key outside below center horizontal Left reverse samplen 1.5 spacing 1.15 height 0.6
set title offset 0,-0.3
set xlabel offset 0,0.5
set pointintervalbox 0
set bars small
set palette defined (0 '#F4F1E6', 0.35 sky, 0.7 blue, 1 '#3B0F70')
set linetype 1 lc rgb '#0072B2' pt 7 ps 0.9 lw 1.3
set linetype 2 lc rgb '#D55E00' pt 9 ps 0.9 lw 1.3
set linetype 3 lc rgb '#009E73' pt 5 ps 0.9 lw 1.3
set linetype 4 lc rgb '#CC79A7' pt 13 ps 0.9 lw 1.3
set linetype 5 lc rgb '#E69F00' pt 11 ps 0.9 lw 1.3
set linetype 6 lc rgb '#56B4E9' pt 15 ps 0.9 lw 1.3
set linetype 7 lc rgb '#000000' pt 6 ps 0.9 lw 1.3
set linetype 8 lc rgb '#9A9A9A' pt 4 ps 0.9 lw 1.3
set multiplot
set lmargin at screen 0.19
set rmargin at screen 0.95
set xlabel 'W'
set xrange [2.38230497:102.809956]
set logscale x
set xtics ('' 3 1, '' 4 1, 5, '' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100)
set format x '%g'
set ylabel 'T̄_{z}'
set yrange [0.33618616:0.640692369]
unset logscale y
set ytics 0.05
set format y '%g'
set format x ''
set xlabel ''
set title '2D rough, algebraic: y = a (1 + c x^{-b})'
set tmargin at screen 0.92
set bmargin at screen 0.44
set key at screen 0.5,0.01 center bottom horizontal maxcols 3
plot 'p2-fig8-2d-algebraic.dat' index 1 using 1:3:4 with filledcurves fc rgb sky fs transparent solid 0.35 noborder title '95 % band', 'p2-fig8-2d-algebraic.dat' index 1 using 1:2 with lines lw 1.8 lc rgb blue title 'algebraic', 'p2-fig8-2d-algebraic.dat' index 0 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#222222' title 'points'
unset key
unset title
set xlabel 'W'
set xrange [2.38230497:102.809956]
set logscale x
set xtics ('' 3 1, '' 4 1, 5, '' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100)
set format x '%g'
set ylabel 'residual'
set yrange [-0.0198514605:0.0247153155]
unset logscale y
set ytics 0.01
set format y '%g'
set tmargin at screen 0.40
set bmargin at screen 0.21
plot 0 with lines lw 1.3 lc rgb blue, 'p2-fig8-2d-algebraic.dat' index 0 using 1:5 with impulses lw 1.3 lc rgb grey, 'p2-fig8-2d-algebraic.dat' index 0 using 1:5 with points pt 7 lc rgb '#222222'
unset multiplot
unset output
reset
}
