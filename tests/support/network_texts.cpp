// SPDX-License-Identifier: GPL-3.0-or-later
#include "network_texts.hpp"

namespace nscdd::testing {

NetworkTexts square_on_plank() {
  NetworkTexts texts;
  texts.datbox.bodies = R"($bdyty
 RBDY2      1
$blmty
 PLAIN      1  behav  STONE  avrd= 0.0000000D+00  gyrd= 0.0000000D+00
$nodty
 NO3xx      1                coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00
$tacty
 POLYG      1  color  BLEUx  nb_vertex=    5      byrd= 0.0000000D+00
                             coo1= 0.0000000D+00  coo2= 0.0000000D+00
                             coo1= 0.1000000D+01  coo2= 0.0000000D+00
                             coo1= 0.2000000D+01  coo2= 0.0000000D+00
                             coo1= 0.2000000D+01  coo2= 0.2000000D+01
                             coo1= 0.0000000D+00  coo2= 0.2000000D+01
$$$$$$

$bdyty
 RBDY2      2
$blmty
 PLAIN      1  behav  STONE  avrd= 0.0000000D+00  gyrd= 0.0000000D+00
$nodty
 NO3xx      1                coo1= 0.1000000D+01  coo2=-0.5000000D+00  coo3= 0.0000000D+00
$tacty
 JONCx      1  color  WALLx  ax1 = 3.0000000E+00  ax2 = 5.0000000E-01
$$$$$$

$bdyty
 RBDY2      3
$blmty
 PLAIN      1  behav  STONE  avrd= 0.5641896D+00  gyrd= 0.5000000D+00
$nodty
 NO3xx      1                coo1= 0.2000000D+01  coo2= 0.3000000D+01  coo3= 0.0000000D+00
$tacty
 POLYG      1  color  BLEUx  nb_vertex=    3      byrd= 0.0000000D+00
                             coo1=-0.1000000D+01  coo2=-0.1000000D+01
                             coo1= 0.1000000D+01  coo2=-0.1000000D+01
                             coo1= 0.0000000D+00  coo2= 0.2000000D+01
$$$$$$
)";
  texts.datbox.bulk = R"($gravy
                   grv1= 0.0000000D+00  grv2=-0.1000000D+02  grv3= 0.0000000D+00
$behav  lawty
 STONE  THERMO_RIGID                    Umas= 0.3000000D+01
)";
  texts.datbox.tact = R"($behav  lawty
 iqsc0  IQS_CLB                         fric= 0.5000000D+00
$behav  lawty
 rstc0  RST_CLB                         rstn= 0.5000000D+00  rstt= 0.2500000D+00
                                        fric= 0.3000000D+00
)";
  texts.datbox.driven = R"($bdyty
 RBDY2      2
$nodty
 NO3xx      1
 vlocy      1  0.1250000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
 vlocy      2  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
 vlocy      3  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
$$$$$$
$bdyty
 RBDY2      3
$nodty
 NO3xx      1
 vlocy      1  0.5000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
 vlocy      3  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
 force      2  0.6000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00
$$$$$$
)";
  texts.datbox.initial = R"($steps       10              time= 0.1000000D+00
$bdyty
 RBDY2        1
$nodty
 NO3xx      1                X(1)= 0.0000000D+00  X(2)= 0.0000000D+00  X(3)= 0.0000000D+00
                             V(1)= 0.5000000D+00  V(2)=-0.1000000D+01  V(3)= 0.2500000D+00
$$$$$$
$bdyty
 RBDY2        3
$nodty
 NO3xx      1                X(1)= 0.0000000D+00  X(2)= 0.0000000D+00  X(3)= 0.0000000D+00
                             V(1)= 0.5000000D+00  V(2)=-0.2000000D+01  V(3)= 0.0000000D+00
$$$$$$
)";
  texts.contacts = R"(
! Vloc_Rloc

$steps       10              time= 0.1000000D+00

!-----------------------------------------------------------------------
$icdan  PLJCx        1
 cdbdy  numbr  cdtac  numbr  vertx  numbr  behav  anbdy  numbr  antac  numbr                sttus iadj
 RBDY2      1  POLYG      1  CDVER      2  iqsc0  RBDY2      2  JONCx      1                stick     1
                             rlt/H 0.4000000D+01  rln/H 0.1200000D+02  rls/H 0.0000000D+00
                             vlt = 0.1000000D+00  vln = 0.2000000D+00  vls = 0.0000000D+00
                             gapTT 0.1000000D-01
                             n(1)= 0.0000000D+00  n(2)= 0.1000000D+01  n(3)= 0.0000000D+00
                             coo1= 0.1500000D+01  coo2= 0.0000000D+00  coo3= 0.0000000D+00

$icdan  PLPLx        1
 cdbdy  numbr  cdtac  numbr  vertx  numbr  behav  anbdy  numbr  antac  numbr  segmt  numbr  sttus  iadj
 RBDY2      3  POLYG      1  CDVER      2  rstc0  RBDY2      1  POLYG      1  ANSEG      3  noctc     1
                             rlt/H 0.0000000D+00  rln/H 0.3000000D+01  rls/H 0.0000000D+00
                             vlt = 0.1000000D+00  vln = 0.2000000D+00  vls = 0.0000000D+00
                             gapTT-0.1000000D-02
                             n(1)= 0.6000000D+00  n(2)= 0.8000000D+00  n(3)= 0.0000000D+00
                             coo1= 0.1800000D+01  coo2= 0.2100000D+01  coo3= 0.0000000D+00
)";
  return texts;
}

NetworkTexts box_on_plane() {
  NetworkTexts texts;
  texts.datbox.bodies = R"($bdyty
 RBDY3      1
$blmty
 PLAIN      1  behav  STONE  avrd= 0.0000000D+00  gyrd= 0.0000000D+00
$nodty
 NO6xx      1                coo1= 0.4000000D+01  coo2= 0.4000000D+01  coo3= 0.4000000D+01
                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00
$tacty
 POLYR      1  color  REDxx  nb_vertex=    8      nb_face=   12
                             coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00
                             coo1= 0.2000000D+01  coo2= 0.0000000D+00  coo3= 0.0000000D+00
                             coo1= 0.2000000D+01  coo2= 0.4000000D+01  coo3= 0.0000000D+00
                             coo1= 0.0000000D+00  coo2= 0.4000000D+01  coo3= 0.0000000D+00
                             coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.6000000D+01
                             coo1= 0.2000000D+01  coo2= 0.0000000D+00  coo3= 0.6000000D+01
                             coo1= 0.2000000D+01  coo2= 0.4000000D+01  coo3= 0.6000000D+01
                             coo1= 0.0000000D+00  coo2= 0.4000000D+01  coo3= 0.6000000D+01
                             ver1= 1              ver2= 2              ver3= 3
                             ver1= 1              ver2= 3              ver3= 4
                             ver1= 5              ver2= 6              ver3= 7
                             ver1= 5              ver2= 7              ver3= 8
                             ver1= 1              ver2= 2              ver3= 6
                             ver1= 1              ver2= 6              ver3= 5
                             ver1= 2              ver2= 3              ver3= 7
                             ver1= 2              ver2= 7              ver3= 6
                             ver1= 3              ver2= 4              ver3= 8
                             ver1= 3              ver2= 8              ver3= 7
                             ver1= 4              ver2= 1              ver3= 5
                             ver1= 4              ver2= 5              ver3= 8
$$$$$$
$bdyty
 RBDY3      2
$blmty
 PLAIN      1  behav  STONE  avrd= 0.0000000D+00  gyrd= 0.0000000D+00
$nodty
 NO6xx      1                coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00
                             coo4= 0.0000000D+00  coo5= 0.0000000D+00  coo6= 0.0000000D+00
$tacty
 PLANx      1  color  WALLx  axe1= 9.0000000E+00  axe2= 9.0000000E+00  axe3= 1.0000000E+00
$$$$$$
)";
  texts.datbox.bulk = R"($gravy
                   grv1= 0.0000000D+00  grv2= 0.0000000D+00  grv3= 0.0000000D+00
$behav  lawty
 STONE  RIGID                           Umas= 0.1000000D+01
)";
  texts.datbox.tact = "$behav  lawty\n iqsc0  IQS_CLB                         fric= 0.5000000D+00\n";
  texts.datbox.driven = "$bdyty\n RBDY3      2\n$nodty\n NO6xx      1\n";
  for (const char* dof : {"1", "2", "3", "4", "5", "6"})
    texts.datbox.driven += std::string(" vlocy      ") + dof + (*dof == '3' ? " -0.1000000D+00" : "  0.0000000D+00") +
                           "  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01  0.0000000D+00\n";
  texts.datbox.driven += "$$$$$$\n";
  texts.datbox.initial = R"($steps        0              time= 0.0000000D+00
$bdyty
 RBDY3        1
$nodty
 NO6xx      1                X(1)= 0.0000000D+00  X(2)= 0.0000000D+00  X(3)= 0.0000000D+00
                             X(4)= 0.0000000D+00  X(5)= 0.0000000D+00  X(6)= 0.0000000D+00
                             V(1)= 0.1000000D+01  V(2)= 0.2000000D+01  V(3)= 0.3000000D+01
                             V(4)= 0.1000000D+00  V(5)= 0.2000000D+00  V(6)= 0.3000000D+00
                             a(1)= 0.0000000D+00  a(2)= 0.1000000D+01  a(3)= 0.0000000D+00
                             b(1)=-0.1000000D+01  b(2)= 0.0000000D+00  b(3)= 0.0000000D+00
                             g(1)= 0.0000000D+00  g(2)= 0.0000000D+00  g(3)= 0.1000000D+01
$$$$$$
)";
  texts.contacts = R"(
$steps        0              time= 0.0000000D+00
$icdan  PRPLx        1
 cdbdy  numbr  cdtac  numbr  CDVER  behav  anbdy  numbr  antac  numbr  sttus
 RBDY3      1  POLYR      1      3  iqsc0  RBDY3      2  PLANx      1  stick
                             rls/H-0.2000000D+01  rlt/H-0.4000000D+01  rln/H 0.1000000D+02
                             vls = 0.1000000D+00  vlt = 0.2000000D+00  vln = 0.3000000D+00
                             gapTT-0.1000000D-08
                             coo1= 0.6000000D+01  coo2= 0.4000000D+01  coo3= 0.4000000D+01
                             t(1)= 0.1000000D+01  t(2)= 0.0000000D+00  t(3)= 0.0000000D+00
                             n(1)= 0.0000000D+00  n(2)= 0.0000000D+00  n(3)= 0.1000000D+01
                             s(1)= 0.0000000D+00  s(2)=-0.1000000D+01  s(3)= 0.0000000D+00
)";
  return texts;
}

}  // namespace nscdd::testing
