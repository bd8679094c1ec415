# T_z/(m V_p^2) against W
# gnuplot p2-fig2.gp draws p2-fig2.svg, p2-fig2.pdf and p2-fig2.png
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
set output 'p2-fig2.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xlabel 'W = V_p^2/(d g)'
set ylabel 'T_z/(m V_p^2)'
set key above
set xrange [0.4:150]
set logscale x
set yrange [0:*]
set arrow from 0.5,graph 0.95 to 9,graph 0.95 heads size graph 0.01,90 lc rgb '#777777'
set label 'Warr et al.' at 0.52,graph 0.975 font ',9' tc rgb '#777777'
set arrow from 44,graph 0.48 to 135,graph 0.48 heads size graph 0.01,90 lc rgb '#777777'
set label 'Feitosa, Menon' at 44,graph 0.505 font ',9' tc rgb '#777777'

plot 'p2-fig2.dat' index 0 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 7 lc rgb '#D55E00' title '2D rough', 'p2-fig2.dat' index 1 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 9 lc rgb '#0072B2' title '3D rough', 'p2-fig2.dat' index 2 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 5 lc rgb '#009E73' title '2D smooth', 'p2-fig2.dat' index 3 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 13 lc rgb '#CC79A7' title '3D smooth', 'p2-fig2.dat' index 4 using 1:2 with lines lw 1.3 dt 2 lc rgb '#D55E00' title 'Table III, 2D rough', 'p2-fig2.dat' index 5 using 1:2 with lines lw 1.3 dt 3 lc rgb '#0072B2' title 'Table III, 3D rough'
unset output
reset
}
