"""What all tests share."""


def pytest_configure(config):
    # Every URDF that is made anew tells so.
    config.addinivalue_line("filterwarnings", "ignore:effort and velocity limits are not known")
