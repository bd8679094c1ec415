# Lift of the centre of mass against V_p
# gnuplot p2-table2.gp draws p2-table2.svg, p2-table2.pdf and p2-table2.png
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
set output 'p2-table2.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xlabel 'V_p/(g d)^{1/2}'
set ylabel 'dh_cm/d'
set key above
set logscale xy
set key outside right top

plot 'p2-table2.dat' index 0 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 7 lc rgb '#D55E00' title 'Warr et al., 2D rough', 'p2-table2.dat' index 1 using 1:2 with lines lw 1.3 dt 1 lc rgb '#D55E00' title 'alpha_h = 1.407', 'p2-table2.dat' index 2 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 9 lc rgb '#0072B2' title '2D rough, [W_f, W_2]', 'p2-table2.dat' index 3 using 1:2 with lines lw 1.3 dt 1 lc rgb '#0072B2' title 'alpha_h = 1.358', 'p2-table2.dat' index 4 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 5 lc rgb '#009E73' title '3D rough, [W_f, W_2]', 'p2-table2.dat' index 5 using 1:2 with lines lw 1.3 dt 1 lc rgb '#009E73' title 'alpha_h = 0.967'
unset output
reset
}
