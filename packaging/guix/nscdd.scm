;;; SPDX-License-Identifier: GPL-3.0-or-later
;;; Recipe of nscdd for Guix, from the checkout that it lies in: guix build -f packaging/guix/nscdd.scm
(use-modules (gnu packages algebra)
             (gnu packages cpp)
             (gnu packages maths)
             (gnu packages ninja)
             (gnu packages oneapi)
             (gnu packages pretty-print)
             (guix build-system cmake)
             (guix gexp)
             (guix git-download)
             ((guix licenses) #:prefix license:)
             (guix packages)
             (guix utils))

(define checkout
  (dirname (dirname (current-source-directory))))

(package
  (name "nscdd")
  (version "0.2.0")
  (source (local-file checkout "nscdd-checkout"
                      #:recursive? #t
                      #:select? (or (git-predicate checkout) (const #t))))
  (build-system cmake-build-system)
  (arguments
   (list
    #:tests? #f                         ; those of the tree need MUMPS, VTK and minutes
    #:configure-flags
    #~(list "-GNinja"
            "-DNSCDD_TESTS=OFF"
            ;; One library has BLAS, LAPACK and LAPACKE here.
            (string-append "-DLAPACKE_LIBRARY=" #$(this-package-input "openblas") "/lib/libopenblas.so"))
    #:phases
    #~(modify-phases %standard-phases
        (replace 'build
          (lambda* (#:key parallel-build? #:allow-other-keys)
            (invoke "cmake" "--build" "." "--parallel"
                    (number->string (if parallel-build? (parallel-job-count) 1)))))
        (replace 'install
          (lambda _ (invoke "cmake" "--install" ".")))
        (add-after 'install 'compare-with-exact-radius
          ;; rho(B_0) of the 4 disks of the paper is (29 + sqrt 57)/56 = 0.65267561491554...
          (lambda _
            (invoke "sh" "-c"
                    (string-append #$output "/bin/nscdd sweep disks4 --epsilon 0 --csv - "
                                   "| grep '0[.]65267561491'")))))))
  (native-inputs (list ninja nlohmann-json tomlplusplus))
  (inputs (list arpack-ng fmt-9 gsl hdf5 metis onetbb openblas suitesparse))
  (propagated-inputs (list eigen))      ; the headers of nscdd include those of Eigen
  (home-page #f)
  (synopsis "Convergence of domain decomposition on granular media")
  (description
   "A packing of rigid grains in contact is cut into subdomains, and an iteration goes back and forth between the
contacts of each subdomain and the impulses that hold the copies of shared grains together.  nscdd computes the rate
of that iteration, the spectral radius of its contraction operator, and proves that no eigenvalue was missed.  It also
runs the iteration, on packings that move and with friction.")
  (license license:gpl3+))
