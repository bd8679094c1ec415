# T_z/(m V_p^2) with μ
# gnuplot p2-fig9c.gp draws p2-fig9c.svg, p2-fig9c.pdf and p2-fig9c.png
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
set output 'p2-fig9c.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xlabel 'W = V_p^2/(d g)'
set ylabel 'T_z/(m V_p^2)'
set key above
set logscale x
set xrange [1:150]
set yrange [0:*]

plot 'p2-fig9c.dat' index 0 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 7 lc rgb '#D55E00' title 'μ = 0.1', 'p2-fig9c.dat' index 1 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 9 lc rgb '#0072B2' title 'μ = 0.4', 'p2-fig9c.dat' index 2 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 5 lc rgb '#009E73' title 'μ = 0.8'
unset output
reset
}
