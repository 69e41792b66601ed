"""The figures of films."""

from webdemo.benchmark.films import measure_film


def test_films_are_measured_with_their_processes() -> None:
    figures = measure_film()
    assert 0.02 < figures["film_processor_seconds"] < 100 and figures["film_seconds"] > 0.02
