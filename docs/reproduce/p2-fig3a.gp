# W = 1.4
# gnuplot p2-fig3a.gp draws p2-fig3a.svg, p2-fig3a.pdf and p2-fig3a.png
blue = '#0072B2'
orange = '#E69F00'
vermilion = '#D55E00'
green = '#009E73'
sky = '#56B4E9'
purple = '#CC79A7'
grey = '#9A9A9A'
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 420,420 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 4.666666666666667in,4.666666666666667in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 672,672 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p2-fig3a.' . kind
set encoding utf8
set border lw 1 lc rgb '#444444'
set tics textcolor rgb '#222222'
set grid lw 0.5 lc rgb '#DDDDDD'
set datafile missing '?'
set xrange [0:10]
set yrange [-1:9]
set size ratio -1
set style fill solid 0.9 border -1
set palette defined (0 '#F0F0F0', 1 vermilion)
set cbrange [0:1]
set cblabel 'speed about the centre of mass/V_p'
set xlabel 'x/d'
set ylabel 'z/d'
unset key
plot 'p2-fig3a.dat' using 1:2:3:4 with circles fc palette, 0 lw 3 lc rgb '#222222'
unset output
reset
}
