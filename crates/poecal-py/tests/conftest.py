"""Common settings of all tests."""


def pytest_configure(config):
    # Every newly made URDF warns of this.
    config.addinivalue_line("filterwarnings", "ignore:effort and velocity limits are not known")
