set object rectangle from graph 0, graph 0 to graph 1, graph 1 behind fs solid 1 noborder fc '#cdcdcd'
set terminal pngcairo noenhanced size 1400,998 font 'sans,14' background '#ffffff'
set output 'map.png'
set encoding utf8
set key off
set clip two
set label 'Keys of terrain' at screen 0.50000, screen 0.96593 center font ',19'
set lmargin at screen 0.10929
set rmargin at screen 0.77143
set tmargin at screen 0.92986
set bmargin at screen 0.08517
set xrange [600000:600110]
set yrange [5200000:5200100]
set xtics ('600 000' 600000, '600 020' 600020, '600 040' 600040, '600 060' 600060, '600 080' 600080, '600 100' 600100)
set ytics ('5 200 000' 5200000, '5 200 020' 5200020, '5 200 040' 5200040, '5 200 060' 5200060, '5 200 080' 5200080, '5 200 100' 5200100)
set tics out nomirror font ',12' tc '#333333' scale 0.8
set border 15 lc '#444444' lw 1.2
set label 'East [m]' at screen 0.44036, screen 0.02505 center font ',13' tc '#333333'
set label 'North [m]' at screen 0.02000, screen 0.50752 center rotate by 90 font ',13' tc '#333333'
set arrow from screen 0.80000, screen 0.91984 to screen 0.83000, screen 0.91984 nohead lw 2.5 lc '#d01c1c'
set label 'Release' at screen 0.83857, screen 0.91984 font ',12'
set arrow from screen 0.80000, screen 0.88978 to screen 0.83000, screen 0.88978 nohead lw 2 dt (8,5) lc '#111111'
set label 'Domain' at screen 0.83857, screen 0.88978 font ',12'
set arrow from screen 0.80000, screen 0.85972 to screen 0.83000, screen 0.85972 nohead lw 1.2 lc '#8a745f'
set label 'Contours every 5 m' at screen 0.83857, screen 0.85972 font ',12'
set label 'Cells of 10 m' at screen 0.80000, screen 0.82966 font ',12'
set label 'released: 23 967 m3' at screen 0.80000, screen 0.79158 font ',12' tc '#333333'
set label 'ETRS89 / UTM zone 32N' at screen 0.80000, screen 0.76854 font ',12' tc '#333333'
set object rectangle from screen 0.80000, screen 0.09920 to screen 0.86019, screen 0.10822 fs solid 1 border lc '#222222' fc '#222222' lw 1
set object rectangle from screen 0.86019, screen 0.09920 to screen 0.92039, screen 0.10822 fs solid 1 border lc '#222222' fc '#ffffff' lw 1
set label '0' at screen 0.80000, screen 0.12525 center font ',12'
set label '20 m' at screen 0.92039, screen 0.12525 center font ',12'
set object polygon from screen 0.95000, screen 0.19539 to screen 0.94071, screen 0.14930 to screen 0.95000, screen 0.15932 to screen 0.95000, screen 0.19539 fs solid 1 noborder fc '#222222'
set object polygon from screen 0.95000, screen 0.19539 to screen 0.95929, screen 0.14930 to screen 0.95000, screen 0.15932 to screen 0.95000, screen 0.19539 fs empty border lc '#222222' lw 1.2
set label 'N' at screen 0.95000, screen 0.21142 center
plot 'map_shade.bin' binary array=(618,561) format='%uchar%uchar' endian=little origin=(600000.089,5200000.089) dx=0.1779935275 dy=0.1782531194 using 1:1:1:2 with rgbalpha, \
     'map_contours.txt' with lines lw 0.8 lc '#8a745f', \
     'map_index_contours.txt' with lines lw 1.7 lc '#8a745f', \
     'map_heights.txt' using 1:2:3:4 with labels rotate variable font ',11' tc '#3d2f22', \
     'map_release.txt' with lines lw 5 lc '#ffffff', \
     'map_release.txt' with lines lw 2.5 lc '#d01c1c', \
     'map_domain.txt' with lines lw 2 dt (12,7) lc '#111111'
