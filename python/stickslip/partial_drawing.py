"""Parts of a figure that are drawn anew by themselves, several times faster than the whole figure."""

import contextlib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from .needed import needed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Place = tuple[float, float, float, float]


class Regions:
    """Rectangles of a figure, each of which holds the whole of the artists whose middle lies in it.

    Parameters
    ----------
    figure
        Of any backend; where that cannot show a part of a drawing, the whole figure is drawn.
    places
        By name left, bottom, right and top as shares of the figure; they do not overlap.
    """

    def __init__(self, figure: "Figure", places: Mapping[str, Place]) -> None:
        self.figure, self.places = figure, places
        self._renderer: Any = None  # which has the whole figure
        self._boxes: list[Any] = []  # drawn and not shown yet
        self._held = False
        figure.canvas.mpl_connect("draw_event", lambda event: setattr(self, "_renderer", event.renderer))

    def draw(self, *names: str) -> None:
        """Draw these regions as they are now, and show them."""
        canvas = self.figure.canvas
        whole = self._renderer is not None and hasattr(canvas, "blit") and canvas.get_renderer() is self._renderer
        if not whole:  # such as after a change of the size, or a saved picture
            self._boxes.clear()
            canvas.draw_idle()
            return
        patches, transforms = needed("matplotlib.patches"), needed("matplotlib.transforms")
        for name in names:
            left, bottom, right, top = self.places[name]
            ground = patches.Rectangle((left, bottom), right - left, top - bottom, linewidth=0, antialiased=False,
                                       color=self.figure.get_facecolor(), transform=self.figure.transFigure)
            ground.set_figure(self.figure)
            inside = [artist for artist in self.figure.get_children() if artist is not self.figure.patch
                      and artist.get_visible() and within(middle_of(artist), self.places[name])]
            for artist in (ground, *sorted(inside, key=lambda artist: artist.get_zorder())):
                artist.draw(self._renderer)
            self._boxes.append(transforms.TransformedBbox(transforms.Bbox.from_extents(*self.places[name]),
                                                          self.figure.transFigure))
        if not self._held:
            self._show()

    @contextlib.contextmanager
    def together(self) -> Iterator[None]:
        """Shows what is drawn within at its end: to a page in the browser a picture of the whole is sent each time."""
        outer, self._held = self._held, True
        try:
            yield
        finally:
            self._held = outer
        if not self._held:
            self._show()

    def _show(self) -> None:
        boxes, self._boxes = self._boxes, []
        of_page = hasattr(self.figure.canvas, "get_diff_image")  # which finds out by itself what has changed
        for box in boxes[:1] if of_page else boxes:
            self.figure.canvas.blit(box)


def middle_of(artist: Any) -> tuple[float, float]:
    """A point of an artist that lies in its region: the middle of axes and rectangles, the anchor of a text."""
    if hasattr(artist, "get_width"):
        return artist.get_x() + artist.get_width() / 2, artist.get_y() + artist.get_height() / 2
    place = artist.get_position()
    return place if isinstance(place, tuple) else ((place.x0 + place.x1) / 2, (place.y0 + place.y1) / 2)


def within(point: tuple[float, float], place: Place) -> bool:
    return place[0] <= point[0] < place[2] and place[1] <= point[1] < place[3]
