# α over [W_f, W_2] with e
# gnuplot p2-fig10-e.gp draws p2-fig10-e.svg, p2-fig10-e.pdf and p2-fig10-e.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 640,460 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 7.111111111111111in,5.111111111111111in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1024,736 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p2-fig10-e.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xlabel 'e'
set ylabel 'α'
set key above
set yrange [0:2.5]
set offsets graph 0.05, graph 0.05, 0, 0
unset key

plot 'p2-fig10-e.dat' index 0 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 7 lc rgb '#D55E00' title 'alpha'
unset output
reset
}
