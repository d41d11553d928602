#!/usr/bin/env python3
"""Writes the made-up maps of validation/similarity_solution and validation/rotated_bowls.

    scripts/make_validation_maps.py FOLDER

FOLDER/similarity_solution/plane/: terrain.asc, a plane of 35 degrees falling towards the east, 600 m x 300 m in plan, pixels of
20 m; release.asc, a parabolic cap on it, thickness normal to the plane, pixels of 4 m.
FOLDER/rotated_bowls/: turned_00, turned_30, turned_45 with terrain.asc, one valley three times, whose axis points 0, 30 and 45
degrees north of east, pixels of 5 m, and release.geojson, a disk (a polygon of 64 corners) at its head.
"""
import json
import math
import pathlib
import sys

EAST, NORTH = 640000.0, 5190000.0  # of the south-west corner, in ETRS89 / UTM zone 32N

# The cap of the similarity solution: Hutter et al. 1993, with the numbers of the test of AvaFrame.
SLOPE = math.radians(35)
CAP_HEIGHT, CAP_RADIUS = 4.0, 80.0  # both measured on the plane [m]
CAP_EAST, CAP_NORTH = 110.0, 150.0  # its middle, from the south-west corner, in plan [m]

# The valley: along its axis a parabola that ends level, across it another one.
SIDE = 480.0    # of the square map [m]
MIDDLE = SIDE / 2
TOP, FOOT = -220.0, 20.0  # along the axis, from the middle of the map: where it is 38 degrees steep and where it is level [m]
CURVATURE = math.tan(math.radians(38)) / (FOOT - TOP)  # of the axis [1/m]
CROSS = 0.004    # of a section across the axis [1/m]
DISK, DISK_RADIUS, DISK_THICKNESS = -150.0, 30.0, 5.0  # the release: place along the axis, radius in plan, normal thickness [m]


def write_raster(path, pixel, columns, rows, height, digits):
    """An ESRI ASCII raster of height(x, y) at the middles of its pixels, x, y from the south-west corner [m]."""
    lines = [f"ncols {columns}", f"nrows {rows}", f"xllcorner {EAST:.0f}", f"yllcorner {NORTH:.0f}", f"cellsize {pixel:g}",
             "NODATA_value -9999"]
    for row in range(rows):
        y = (rows - row - 0.5) * pixel
        lines.append(" ".join(f"{height((c + 0.5) * pixel, y):.{digits}f}" for c in range(columns)))
    path.write_text("\n".join(lines) + "\n")


def plane(x, _y):
    return 500 - math.tan(SLOPE) * x


def cap(x, y):
    """Thickness normal to the plane: the place on the plane is 1/cos as far down the slope as in plan."""
    down, across = (x - CAP_EAST) / math.cos(SLOPE), y - CAP_NORTH
    return max(0.0, CAP_HEIGHT * (1 - (down**2 + across**2) / CAP_RADIUS**2))


def valley(turn):
    """Height over a place on the map, of a valley whose axis is turned by `turn` from east to north."""
    c, s = math.cos(turn), math.sin(turn)

    def height(x, y):
        along, across = c * (x - MIDDLE) + s * (y - MIDDLE), -s * (x - MIDDLE) + c * (y - MIDDLE)
        return 100 + 0.5 * CURVATURE * min(0.0, along - FOOT)**2 + CROSS * across**2

    return height


def disk(turn):
    x, y = MIDDLE + DISK * math.cos(turn), MIDDLE + DISK * math.sin(turn)
    corners = [[EAST + x + DISK_RADIUS * math.cos(a), NORTH + y + DISK_RADIUS * math.sin(a)]
               for a in (turn + 2 * math.pi * k / 64 for k in range(65))]
    return {"type": "FeatureCollection",
            "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}},
            "features": [{"type": "Feature", "properties": {"thickness": DISK_THICKNESS},
                          "geometry": {"type": "Polygon", "coordinates": [[[round(v, 4) for v in p] for p in corners]]}}]}


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    to = folder / "similarity_solution" / "plane"
    to.mkdir(parents=True, exist_ok=True)
    write_raster(to / "terrain.asc", 20, 30, 15, plane, 6)
    write_raster(to / "release.asc", 4, 150, 75, cap, 3)
    for degrees in (0, 30, 45):
        to = folder / "rotated_bowls" / f"turned_{degrees:02d}"
        to.mkdir(parents=True, exist_ok=True)
        write_raster(to / "terrain.asc", 5, int(SIDE) // 5, int(SIDE) // 5, valley(math.radians(degrees)), 2)
        (to / "release.geojson").write_text(json.dumps(disk(math.radians(degrees))) + "\n")


main()
