"""What a penny-shaped crack opens by, from the openings at the nodes of its facets, the same for all programs.

Sneddon (1946), in unbounded rock: opening 8 (1 - nu^2) p a / (pi E) sqrt(1 - r^2 / a^2), volume
16 (1 - nu^2) p a^3 / (3 E), K_I = 2 p sqrt(a / pi).
"""

import numpy as np

import penny_case as case

PLANE_MODULUS = case.YOUNG_MODULUS / (1.0 - case.POISSON_RATIO**2)
"""E / (1 - nu^2) (Pa)."""

EXACT = {
    "centre": 8.0 * case.PRESSURE / (np.pi * PLANE_MODULUS),
    "volume": 16.0 * case.PRESSURE / (3.0 * PLANE_MODULUS),
    "intensity": 2.0 * case.PRESSURE / np.sqrt(np.pi),
}
"""Opening at the centre (m), volume (m^3) and K_I (Pa sqrt(m)) for a radius of 1 m."""

FIT = (0.05, 0.4)
"""Distances from the rim (m) of the facets whose openings give K_I."""

A, B = 0.445948490915965, 0.091576213509771
QUADRATURE = np.array([[A, A], [1 - 2 * A, A], [A, 1 - 2 * A], [B, B], [1 - 2 * B, B], [B, 1 - 2 * B]])
WEIGHTS = np.repeat([0.223381589678011 / 2, 0.109951743655322 / 2], 3)
"""Exact for polynomials of degree 4 on the unit triangle (Dunavant 1985), so for curved facets of second order too."""


def shape(count, place):
    """Values and both derivatives of the shape functions of a triangle of 3 or 6 nodes, rows (3, count)."""
    s, t = place
    corners = np.array([1.0 - s - t, s, t])
    slopes = np.array([[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]])
    if count == 3:
        return np.vstack([corners, slopes])
    after = np.roll(corners, -1)
    values = np.concatenate([corners * (2.0 * corners - 1.0), 4.0 * corners * after])
    inner = slopes * (4.0 * corners - 1.0)
    middles = 4.0 * (slopes * after + corners * np.roll(slopes, -1, axis=1))
    return np.vstack([values, np.hstack([inner, middles])])


def facet_means(points, openings):
    """Areas (m^2), centroids (m) and mean openings (m) of the facets, which lie in the plane z = 0."""
    area, moment, volume = 0.0, 0.0, 0.0
    for place, weight in zip(QUADRATURE, WEIGHTS):
        values, along_s, along_t = shape(openings.shape[1], place)
        u, v = (np.einsum("n,fnd->fd", slope, points[:, :, :2]) for slope in (along_s, along_t))
        part = weight * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        area = area + part
        moment = moment + part[:, None] * np.einsum("n,fnd->fd", values, points)
        volume = volume + part * (openings @ values)
    return area, moment / area[:, None], volume / area


def centre_opening(points, openings):
    """The opening (m) at the origin, interpolated in the facet there."""
    nearest = np.argsort(np.linalg.norm(points[:, :3].mean(axis=1), axis=1))[:20]
    for facet in nearest:
        place = np.array([1.0, 1.0]) / 3.0
        for _ in range(20):
            values, *slopes = shape(openings.shape[1], place)
            place = place - np.linalg.solve((np.array(slopes) @ points[facet, :, :2]).T, values @ points[facet, :, :2])
        if min(*place, 1.0 - place.sum()) > -1e-9:
            return shape(openings.shape[1], place)[0] @ openings[facet]
    raise ValueError("no facet at the centre")


def intensity(centroids, means):
    """K_I (Pa sqrt(m)): w = 8 K_I / E' sqrt(d / (2 pi)) at the rim; w^2 / d is fitted by a line and taken there."""
    distance = 1.0 - np.linalg.norm(centroids[:, :2], axis=1)
    near = (distance >= FIT[0]) & (distance <= FIT[1])
    _, value = np.polyfit(distance[near], means[near] ** 2 / distance[near], 1)
    return PLANE_MODULUS / 8.0 * np.sqrt(2.0 * np.pi * value)


def errors(points, openings):
    """Relative errors of centre opening, volume and K_I, signed."""
    areas, centroids, means = facet_means(points, openings)
    found = {
        "centre": centre_opening(points, openings),
        "volume": areas @ means,
        "intensity": intensity(centroids, means),
    }
    return {name: float(value / EXACT[name] - 1.0) for name, value in found.items()}
