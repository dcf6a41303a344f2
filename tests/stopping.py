"""A run that ends between two load steps, as an interrupted one does."""


class Stop(Exception):
    """Ends a run between two steps."""


class Stopper:
    """Watcher that raises `Stop` before a step, the last one at the latest."""

    def __init__(self, index):
        self.index = index

    def step_started(self, point, total):
        if point.index == min(self.index, total):
            raise Stop

    def iterated(self, text, residual, tolerance):
        pass

    def step_finished(self, record, total):
        pass
