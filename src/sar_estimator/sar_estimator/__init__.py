"""Helicopter motion and corner estimation from GPS fixes."""
