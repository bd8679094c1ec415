# W = 2.01
# gnuplot p2-fig3b.gp draws p2-fig3b.svg, p2-fig3b.pdf and p2-fig3b.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 480,579 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 5.333333333333333in,6.433333333333334in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 768,926 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p2-fig3b.' . kind
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
set size ratio -1
set xlabel 'x/d'
set ylabel 'z/d'
set xrange [0:10]
set yrange [-1:12]
set title '{/:Bold (b)} 2D smooth, W = 2.01, for the paper’s W ≲ W_f'
set style fill solid border lc rgb '#444444'
set cbrange [0:4.3]
set cblabel 'speed about the centre of mass/V_p'
unset key
plot 'p2-fig3b.dat' using 1:2:3:4 with circles fc palette, 0 lw 3 lc rgb '#222222'
unset output
reset
}
