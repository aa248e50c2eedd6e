# Makes the table of main.c, its numbers in hundredths of a pixel, of a clip of examples/data:
#   sed -f walk.sed ../data/walk.csv > walk.inc
s|^# *\(.*\)|/* \1 */|
t
s/\.//g
s/.*/{&},/
