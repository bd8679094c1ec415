# α without gravity
# gnuplot p2-fig6.gp draws p2-fig6.svg, p2-fig6.pdf and p2-fig6.png
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
set output 'p2-fig6.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xlabel 'amplitude and number of layers'
set ylabel 'α'
set key above
set xrange [0.5:3.5]
set yrange [1.9:2.1]
set xlabel offset 0,-1
set bmargin 6
set xtics ("A = 1 d\nn = 4" 1, "A = 0.5 d\nn = 4" 2, "A = 2 d\nn = 4" 3)

plot 'p2-fig6.dat' index 0 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 7 lc rgb '#D55E00' title 'k_n ∝ V_p^2', 'p2-fig6.dat' index 1 using 1:2:3:4 with yerrorbars lw 1 ps 0.8 pt 9 lc rgb '#0072B2' title 'one k_n'
unset output
reset
}
