# Fits of T_z/(m V_p^2)
# gnuplot p2-fig8.gp draws p2-fig8.svg, p2-fig8.pdf and p2-fig8.png
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
set output 'p2-fig8.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xlabel 'W = V_p^2/(d g)'
set ylabel 'T_z/(m V_p^2)'
set key above
set logscale xy
set xrange [1:150]
set yrange [0.03:1]
set key inside vertical bottom left

plot 'p2-fig8.dat' index 0 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 7 lc rgb '#D55E00' title '2D rough', 'p2-fig8.dat' index 1 using 1:2 with lines lw 1.3 dt 1 lc rgb '#D55E00' title '2D rough, algebraic', 'p2-fig8.dat' index 2 using 1:2 with lines lw 1.3 dt 2 lc rgb '#D55E00' title '2D rough, exponential', 'p2-fig8.dat' index 3 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 9 lc rgb '#0072B2' title '3D rough', 'p2-fig8.dat' index 4 using 1:2 with lines lw 1.3 dt 1 lc rgb '#0072B2' title '3D rough, algebraic', 'p2-fig8.dat' index 5 using 1:2 with lines lw 1.3 dt 2 lc rgb '#0072B2' title '3D rough, exponential'
unset output
reset
}
