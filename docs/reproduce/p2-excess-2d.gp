# 2D rough
# gnuplot p2-excess-2d.gp draws p2-excess-2d.svg, p2-excess-2d.pdf and p2-excess-2d.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,726 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,8.066666666666666in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,1161 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p2-excess-2d.' . kind
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
set xlabel 'T_z/(m V_p^2) over Table III'
set xrange [0.564:1.536]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 'choice'
set yrange [-0.46:25.46]
unset logscale y
set ytics 5
set format y '%g'
set title '2D rough'
set object rectangle from first 0.9,graph 0 to first 1.1,graph 1 behind fs solid noborder fc rgb '#E3E3E3'
set arrow from first 1,graph 0 to first 1,graph 1 nohead lw 1.5 dt 4 lc rgb '#555555'
set ytics ('as in Fig. 2' 24, 'c_t = 1.25 c_n' 23, 'c_t = 5 c_n' 22, 'k_n = 1e5' 21, 'k_n = 1e7' 20, 'c_n for the mass of one bead' 19, 'e falls with speed' 18, 'moment of inertia of a disc' 17, 'base without friction' 16, 'base with μ = 0.8' 15, 'base with e = 0.8' 14, 'base with the c_n of two beads' 13, 'period 5 d' 12, 'period 20 d (3D: 10 d)' 11, 'rough side walls, riding' 10, 'rough side walls, at rest' 9, 'smooth side walls' 8, 'ceiling at 60 d, at rest' 7, 'ceiling at 60 d, moving' 6, 'ceiling at 100 d, at rest' 5, 'first 100 cycles from rest' 4, 'T_z in the lab frame' 3, 'T_z about the velocity field' 2, 'T_z, mean over the volume' 1)
set key maxcols 2
plot 'p2-excess-2d.dat' index 0 using 1:2:3:4 with xerrorbars lt 1 title 'W = 11', \
     'p2-excess-2d.dat' index 1 using 1:2:3:4 with xerrorbars lt 2 title 'W = 50.3', \
     'p2-excess-2d.dat' index 2 using 1:2:3:4 with xerrorbars lt 3 title 'W = 89.4', \
     keyentry with boxes fs solid noborder fc rgb '#E3E3E3' title 'within 10 %'
unset output
reset
}
