#!/usr/bin/env python3
"""Writes the maps of cases/landslide.toml, a valley that no map has.

    scripts/make_landslide.py FOLDER

FOLDER/terrain.asc (with terrain.prj), heights in m on 120 x 80 pixels of 5 m: a slope of 32 degrees towards the east that
passes into a valley floor of 3 degrees over 150 m, with a gully 60 m wide down the slope, which ends in a flat fan.
FOLDER/release.geojson: two parts of a release in the upper gully, 6 m and 5 m thick (attribute `thickness`).
FOLDER/forest.geojson: a wood on one side of the valley floor, a zone of its own for the surface of the ground.
"""
import json
import math
import pathlib
import sys

COLUMNS, ROWS, PIXEL = 120, 80, 5.0
EAST, NORTH = 640000.0, 5190000.0  # of the south-west corner, in ETRS89 / UTM zone 32N
SLOPE, FLOOR = math.tan(math.radians(32)), math.tan(math.radians(3))
FOOT, BEND = 300.0, 75.0  # the slope passes into the floor between FOOT - BEND and FOOT + BEND [m]
AXIS, WIDTH, DEPTH = 200.0, 60.0, 12.0  # of the gully [m]

PRJ = ('PROJCS["ETRS_1989_UTM_Zone_32N",GEOGCS["GCS_ETRS_1989",DATUM["D_ETRS_1989",SPHEROID["GRS_1980",6378137.0,'
       '298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],'
       'PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",9.0],'
       'PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]')


def slope_to_floor(x):
    """Height of the ground without its gully: two planes and a parabola between them [m]."""
    if x < FOOT - BEND:
        return 900 - SLOPE * x
    across = min(x, FOOT + BEND) - (FOOT - BEND)
    bend = 900 - SLOPE * (FOOT - BEND) - SLOPE * across + (SLOPE - FLOOR) * across**2 / (4 * BEND)
    return bend - FLOOR * max(0.0, x - FOOT - BEND)


def gully(x, y):
    """How deep the gully is cut [m]: a cosine across, which fades out at both ends."""
    across = abs(y - AXIS) / WIDTH
    if across >= 1:
        return 0.0
    fade = min(1.0, max(0.0, x / 40)) * min(1.0, max(0.0, (FOOT + BEND - x) / 120))
    return DEPTH * fade * 0.5 * (1 + math.cos(math.pi * across))


def ring(corners):
    """A closed outline on the map, from corners in m from the south-west corner."""
    return [[EAST + x, NORTH + y] for x, y in [*corners, corners[0]]]


def features(outlines):
    """A GeoJSON of polygons with attributes. The member `crs` is older than RFC 7946, which knows degrees only."""
    return {"type": "FeatureCollection",
            "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}},
            "features": [{"type": "Feature", "properties": attributes,
                          "geometry": {"type": "Polygon", "coordinates": [ring(corners)]}}
                         for corners, attributes in outlines]}


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"ncols {COLUMNS}", f"nrows {ROWS}", f"xllcorner {EAST:.1f}", f"yllcorner {NORTH:.1f}",
             f"cellsize {PIXEL:.1f}", "NODATA_value -9999"]
    for row in reversed(range(ROWS)):  # from the north
        y = (row + 0.5) * PIXEL
        heights = [slope_to_floor(x) - gully(x, y) for x in ((c + 0.5) * PIXEL for c in range(COLUMNS))]
        lines.append(" ".join(f"{z:.2f}" for z in heights))
    (folder / "terrain.asc").write_text("\n".join(lines) + "\n")
    (folder / "terrain.prj").write_text(PRJ + "\n")
    upper = [(50, 175), (95, 165), (95, 235), (50, 225)]
    lower = [(95, 165), (125, 172), (135, 200), (125, 228), (95, 235)]
    wood = [(330, 215), (560, 215), (560, 330), (330, 330)]
    (folder / "release.geojson").write_text(
        json.dumps(features([(upper, {"name": "upper", "thickness": 6.0}), (lower, {"name": "lower", "thickness": 5.0})]),
                   indent=1) + "\n")
    (folder / "forest.geojson").write_text(json.dumps(features([(wood, {"name": "wood"})]), indent=1) + "\n")


main()
