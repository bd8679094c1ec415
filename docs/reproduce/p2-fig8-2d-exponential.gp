# 2D rough, exponential
# gnuplot p2-fig8-2d-exponential.gp draws p2-fig8-2d-exponential.svg, p2-fig8-2d-exponential.pdf and p2-fig8-2d-exponential.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
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
set output 'p2-fig8-2d-exponential.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set multiplot
set lmargin at screen 0.19
set rmargin at screen 0.95
set xrange [-0.728846083:92.8965755]
set tmargin at screen 0.95
set bmargin at screen 0.40
set format x ''
set ylabel 'T̄_{z}'
set key top right samplen 2
plot 'p2-fig8-2d-exponential.dat' index 1 using 1:3:4 with filledcurves fc rgb sky fs transparent solid 0.35 noborder title '95 % band', 'p2-fig8-2d-exponential.dat' index 1 using 1:2 with lines lw 2 lc rgb blue title 'exponential', 'p2-fig8-2d-exponential.dat' index 0 using 1:2:3:4 with yerrorbars pt 7 ps 0.9 lw 1.3 lc rgb '#222222' title 'points'
unset logscale y
set ytics autofreq
unset key
set tmargin at screen 0.35
set bmargin at screen 0.12
set format x '%g'
set format y '%g'
set xlabel 'W'
set ylabel 'residual'
set yrange [*:*]
plot 0 with lines lw 1.5 lc rgb blue, 'p2-fig8-2d-exponential.dat' index 0 using 1:5 with impulses lw 1.3 lc rgb grey, 'p2-fig8-2d-exponential.dat' index 0 using 1:5 with points pt 7 ps 0.9 lc rgb '#222222'
unset multiplot
unset output
reset
}
