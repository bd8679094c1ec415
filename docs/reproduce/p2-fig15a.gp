# Packing fraction, 3D smooth
# gnuplot p2-fig15a.gp draws p2-fig15a.svg, p2-fig15a.pdf and p2-fig15a.png
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
set output 'p2-fig15a.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xlabel 'z/d'
set ylabel 'φ(z)'
set key above
set xrange [0:72]
set yrange [0:*]

plot 'p2-fig15a.dat' index 0 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 7 lc rgb '#D55E00' title 'W = 5.589', 'p2-fig15a.dat' index 1 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 9 lc rgb '#0072B2' title 'W = 22.36', 'p2-fig15a.dat' index 2 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 5 lc rgb '#009E73' title 'W = 50.3', 'p2-fig15a.dat' index 3 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 13 lc rgb '#CC79A7' title 'W = 68.47', 'p2-fig15a.dat' index 4 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 11 lc rgb '#E69F00' title 'W = 85.01'
unset output
reset
}
