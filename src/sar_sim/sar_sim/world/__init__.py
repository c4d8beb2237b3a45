"""The helicopter, its receiver and its UAV."""
