# Contact of two beads
# gnuplot p1-fig6.gp draws p1-fig6.svg, p1-fig6.pdf and p1-fig6.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 540,360 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 6in,4in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 864,576 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig6.' . kind
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
unset tics
unset border
unset grid
unset key
set xrange [-2.1:2.1]
set yrange [-1.5:1.5]
set style arrow 1 head filled size 0.1,18 lw 2 lc rgb '#222222'
set style arrow 2 head filled size 0.1,18 lw 2 lc rgb blue
set style arrow 3 heads size 0.05,90 lw 1.5 lc rgb vermilion
set arrow 1 from 0.84,0.24 to 1.513,0.432 arrowstyle 1 front
set label 1 'n_{ij}' at 1.5,0.56
set arrow 2 from 0,0 to -0.192,0.673 arrowstyle 1 front
set label 2 't_{ij}' at -0.52,0.86 front
set arrow 3 from 0.84,0.24 to 0.45,0.95 arrowstyle 2 front
set label 3 'v_{ij}' at 0.55,1.02 front tc rgb blue
set arrow 4 from -0.122,-0.035 to 0.122,0.035 arrowstyle 3 front
set label 4 'δ_{n}' at 0.14,-0.12 tc rgb vermilion front
set label 5 'j' at -0.9,-0.24 front
set label 6 'i' at 0.8,0.05 front
plot 'p1-fig6.dat' using 1:2:3 with circles fs transparent solid 0.35 border lc rgb '#555555' fc rgb sky
unset output
reset
}
