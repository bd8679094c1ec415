# 2D rough, N = 4 {/*0.85 T_z(z): variance about the mean of the slab at each instant, fewer than two beads count as 0}
# gnuplot p2-fig16b-instant.gp draws p2-fig16b-instant.svg, p2-fig16b-instant.pdf and p2-fig16b-instant.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 640,480 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 7.111111111111111in,5.333333333333333in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1024,768 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p2-fig16b-instant.' . kind
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
set xlabel 'W = V_p^2/(d g)'
set xrange [1.18318061:105.614954]
set logscale x
set xtics (2, '' 3 1, '' 4 1, 5, '' 6 1, '' 7 1, '' 8 1, '' 9 1, 10, 20, '' 30 1, '' 40 1, 50, '' 60 1, '' 70 1, '' 80 1, '' 90 1, 100)
set format x '%g'
set ylabel 'T_z(z)/(m V_p^2)'
set yrange [-0.0129288176:0.336149257]
unset logscale y
set ytics 0.05
set format y '%g'
set title '{/:Bold (b)} 2D rough, N = 4'."\n".'{/*0.85 T_z(z): variance about the mean of the slab at each instant, fewer than two beads count as 0}'
plot 'p2-fig16b-instant.dat' index 0 using 1:2:3:4 with yerrorbars lt 1 title 'z = 0.5 d', \
     'p2-fig16b-instant.dat' index 1 using 1:2:3:4 with yerrorbars lt 2 title 'z = 2.5 d', \
     'p2-fig16b-instant.dat' index 2 using 1:2:3:4 with yerrorbars lt 3 title 'z = 4.5 d', \
     'p2-fig16b-instant.dat' index 3 using 1:2:3:4 with yerrorbars lt 4 title 'z = 7.5 d', \
     'p2-fig16b-instant.dat' index 4 using 1:2:3:4 with yerrorbars lt 5 title 'z = 11.5 d'
unset output
reset
}
