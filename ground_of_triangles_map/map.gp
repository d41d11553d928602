set object rectangle from graph 0, graph 0 to graph 1, graph 1 behind fs solid 1 noborder fc '#cdcdcd'
set terminal pngcairo noenhanced size 1400,1047 font 'sans,14' background '#ffffff'
set output 'map.png'
set encoding utf8
set key off
set clip two
set label 'Keys of ground and solids of triangles' at screen 0.50000, screen 0.96753 center font ',19'
set lmargin at screen 0.07071
set rmargin at screen 0.77143
set tmargin at screen 0.93314
set bmargin at screen 0.08118
set xrange [0:110]
set yrange [0:100]
set xtics ('0' -0, '20' 20, '40' 40, '60' 60, '80' 80, '100' 100)
set ytics ('0' -0, '20' 20, '40' 40, '60' 60, '80' 80, '100' 100)
set tics out nomirror font ',12' tc '#333333' scale 0.8
set border 15 lc '#444444' lw 1.2
set label 'East [m]' at screen 0.42107, screen 0.02388 center font ',13' tc '#333333'
set label 'North [m]' at screen 0.02000, screen 0.50716 center rotate by 90 font ',13' tc '#333333'
set arrow from screen 0.80000, screen 0.92359 to screen 0.83000, screen 0.92359 nohead lw 2 dt (8,5) lc '#111111'
set label 'Domain' at screen 0.83857, screen 0.92359 font ',12'
set arrow from screen 0.80000, screen 0.89494 to screen 0.83000, screen 0.89494 nohead lw 1.2 lc '#8a745f'
set label 'Contours every 5 m' at screen 0.83857, screen 0.89494 font ',12'
set label 'Cells of 10 m' at screen 0.80000, screen 0.86628 font ',12'
set label 'released: 0 m3' at screen 0.80000, screen 0.82999 font ',12' tc '#333333'
set label 'ETRS89 / UTM zone 32N' at screen 0.80000, screen 0.80802 font ',12' tc '#333333'
set object rectangle from screen 0.80000, screen 0.09456 to screen 0.86370, screen 0.10315 fs solid 1 border lc '#222222' fc '#222222' lw 1
set object rectangle from screen 0.86370, screen 0.09456 to screen 0.92740, screen 0.10315 fs solid 1 border lc '#222222' fc '#ffffff' lw 1
set label '0' at screen 0.80000, screen 0.11939 center font ',12'
set label '20 m' at screen 0.92740, screen 0.11939 center font ',12'
set object polygon from screen 0.95000, screen 0.18625 to screen 0.94071, screen 0.14231 to screen 0.95000, screen 0.15186 to screen 0.95000, screen 0.18625 fs solid 1 noborder fc '#222222'
set object polygon from screen 0.95000, screen 0.18625 to screen 0.95929, screen 0.14231 to screen 0.95000, screen 0.15186 to screen 0.95000, screen 0.18625 fs empty border lc '#222222' lw 1.2
set label 'N' at screen 0.95000, screen 0.20153 center
plot 'map_shade.bin' binary array=(654,594) format='%uchar%uchar' endian=little origin=(0.08409785933,0.08417508418) dx=0.1681957187 dy=0.1683501684 using 1:1:1:2 with rgbalpha, \
     'map_contours.txt' with lines lw 0.8 lc '#8a745f', \
     'map_index_contours.txt' with lines lw 1.7 lc '#8a745f', \
     'map_heights.txt' using 1:2:3:4 with labels rotate variable font ',11' tc '#3d2f22', \
     'map_domain.txt' with lines lw 2 dt (12,7) lc '#111111'
