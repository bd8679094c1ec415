# Slip probability
# gnuplot p1-fig5.gp draws p1-fig5.svg, p1-fig5.pdf and p1-fig5.png
do for [kind in 'svg pdf png'] {
if (kind eq 'svg') {
  set terminal svg size 720,1170 dynamic enhanced font 'Arial,15' background 'white'
}
if (kind eq 'pdf') {
  set terminal pdfcairo size 8in,13in enhanced font 'sans,9' background 'white'
}
if (kind eq 'png') {
  set terminal pngcairo size 1152,1872 enhanced font 'sans,14' fontscale 1.25 linewidth 1.6 pointscale 1.6 background 'white'
}
set output 'p1-fig5.' . kind
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
set multiplot
unset key
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.9658
set bmargin at screen 0.7373
set xlabel '1/K_m'
set xrange [-0.0330578512:0.859504132]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 'p_s'
set yrange [3.1774445e-07:5.56406443]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (a)} random, N_l = 20'
set arrow from first 0.23508,graph 0 to first 0.23508,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.11804,graph 0.06 center
set label 'E_b = 11.4' at graph 0.97,0.930 right
set label '(paper 7)' at graph 0.97,0.850 right
set label 'A' at first 0.49067,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 0 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [0.0330579:0.826446] exp(-1.6838896 - 11.355305*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.826446] exp(-3.0097022 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.9658
set bmargin at screen 0.7373
set xlabel '1/K_m'
set xrange [-0.012345679:0.320987654]
unset logscale x
set xtics 0.05
set format x '%g'
set ylabel 'p_s'
set yrange [3.1774445e-07:5.56406443]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (b)} crystal, N_l = 20'
set arrow from first 0.12642,graph 0 to first 0.12642,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.06371,graph 0.06 center
set label 'A_2: E_b = 97.9' at graph 0.97,0.930 right
set label '(paper 130)' at graph 0.97,0.850 right
set label 'B: E_b = 32.3' at graph 0.97,0.710 right
set label '(paper 7)' at graph 0.97,0.630 right
set arrow from first 0.18116,graph 0 to first 0.18116,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_2' at first 0.15379,graph 0.06 center
set label 'A_1' at first 0.27962,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 2 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle, 'p1-fig5.dat' index 3 using 1:2 with points pt 10 lc rgb '#0072B2' notitle, [0.12642:0.173611] exp(7.4820445 - 97.92387*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.12642:0.173611] exp(12.443535 - 130*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle, [0.0330579:0.12642] exp(1.2343494 - 32.269359*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.12642] exp(-0.79224666 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.6484
set bmargin at screen 0.4199
set xlabel '1/K_m'
set xrange [-0.04:1.04]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 'p_s'
set yrange [3.1774445e-07:5.56406443]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (c)} random, N_l = 40'
set arrow from first 0.34099,graph 0 to first 0.34099,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.17099,graph 0.06 center
set label 'E_b = 11.3' at graph 0.97,0.930 right
set label '(paper 7)' at graph 0.97,0.850 right
set label 'A' at first 0.54363,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 4 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [0.0330579:1] exp(-0.38610352 - 11.331343*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:1] exp(-1.8631917 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.6484
set bmargin at screen 0.4199
set xlabel '1/K_m'
set xrange [-0.012345679:0.320987654]
unset logscale x
set xtics 0.05
set format x '%g'
set ylabel 'p_s'
set yrange [3.1774445e-07:5.56406443]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (d)} crystal, N_l = 40'
set arrow from first 0.13845,graph 0 to first 0.13845,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.069727,graph 0.06 center
set label 'A_2: E_b = 252' at graph 0.97,0.930 right
set label '(paper 130)' at graph 0.97,0.850 right
set label 'B: E_b = 18.8' at graph 0.97,0.710 right
set label '(paper 7)' at graph 0.97,0.630 right
set arrow from first 0.16667,graph 0 to first 0.16667,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_2' at first 0.15256,graph 0.06 center
set label 'A_1' at first 0.25694,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 6 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle, 'p1-fig5.dat' index 7 using 1:2 with points pt 10 lc rgb '#0072B2' notitle, [0.138453:0.16] exp(32.663366 - 252.48427*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.138453:0.16] exp(13.805136 - 130*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle, [0.0330579:0.138453] exp(0.39884713 - 18.758795*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.138453] exp(-0.61120031 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.1167
set rmargin at screen 0.4778
set tmargin at screen 0.3311
set bmargin at screen 0.1026
set xlabel '1/K_m'
set xrange [-0.04:1.04]
unset logscale x
set xtics 0.2
set format x '%g'
set ylabel 'p_s'
set yrange [3.1774445e-07:5.56406443]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (e)} random, N_l = 60'
set arrow from first 0.5805,graph 0 to first 0.5805,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.29075,graph 0.06 center
set label 'E_b = 11.2' at graph 0.97,0.930 right
set label '(paper 7)' at graph 0.97,0.850 right
set label 'A' at first 0.66338,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 8 using 1:2:3:4 with yerrorbars pt 9 lc rgb '#009E73' notitle, [0.0330579:1] exp(-0.060365962 - 11.151864*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:1] exp(-1.4762476 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0.6167
set rmargin at screen 0.9778
set tmargin at screen 0.3311
set bmargin at screen 0.1026
set xlabel '1/K_m'
set xrange [-0.012345679:0.320987654]
unset logscale x
set xtics 0.05
set format x '%g'
set ylabel 'p_s'
set yrange [3.1774445e-07:5.56406443]
set logscale y
set ytics autofreq
set format y '10^{%T}'
unset arrow
unset label
set title '{/:Bold (f)} crystal, N_l = 60'
set arrow from first 0.1287,graph 0 to first 0.1287,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'B' at first 0.064849,graph 0.06 center
set label 'A_2: E_b = 174' at graph 0.97,0.930 right
set label '(paper 130)' at graph 0.97,0.850 right
set label 'B: E_b = 9.98' at graph 0.97,0.710 right
set label '(paper 7)' at graph 0.97,0.630 right
set arrow from first 0.18116,graph 0 to first 0.18116,graph 1 nohead lw 1 dt 2 lc rgb '#666666'
set label 'A_2' at first 0.15493,graph 0.06 center
set label 'A_1' at first 0.27962,graph 0.06 center
plot NaN notitle, 'p1-fig5.dat' index 10 using 1:2:3:4 with yerrorbars pt 7 lc rgb '#0072B2' notitle, 'p1-fig5.dat' index 11 using 1:2 with points pt 10 lc rgb '#0072B2' notitle, [0.128698:0.173611] exp(19.341641 - 174.17777*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.128698:0.173611] exp(12.508286 - 130*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle, [0.0330579:0.128698] exp(-0.17974974 - 9.9789166*x) with lines lw 1.8 lc rgb '#333333' notitle, [0.0330579:0.128698] exp(-0.41865809 - 7*x) with lines lw 1.5 dt 4 lc rgb '#555555' notitle
set lmargin at screen 0
set rmargin at screen 1
set tmargin at screen 0.0479
set bmargin at screen 0
unset title
unset xlabel
unset ylabel
unset arrow
unset label
unset object
unset border
unset tics
unset grid
unset logscale
unset xzeroaxis
set key at screen 0.5,0.0051 center bottom horizontal
plot [0:1][0:1] NaN notitle, keyentry with points pt 9 lc rgb '#009E73' title 'random', keyentry with points pt 7 lc rgb '#0072B2' title 'crystal', \
     keyentry with points pt 10 lc rgb '#333333' title 'no slip: limit', \
     keyentry with lines lw 1.8 lc rgb '#333333' title 'Arrhenius law', \
     keyentry with lines lw 1 dt 2 lc rgb '#666666' title 'border of a region', \
     keyentry with lines lw 1.5 dt 4 lc rgb '#555555' title 'paper’s E_b'
unset multiplot
unset output
reset
}
