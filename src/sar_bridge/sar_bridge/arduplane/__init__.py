"""Where a UAV under ArduPlane's lateral guidance will be."""
