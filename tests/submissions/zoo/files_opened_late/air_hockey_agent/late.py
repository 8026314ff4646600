def factor(path):
    return float(open(path).read()) / 0.02
