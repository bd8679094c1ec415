namespace twincell {}
