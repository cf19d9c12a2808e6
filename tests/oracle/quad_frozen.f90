!> Tests. The matrix A of (20) once more, in real128 and for reference angles of any choice; and what the theory says of
!> its iteration: near the solution each error is G = I - A^-1 J times the one before it, J the slopes of the closure.
module quad_frozen
   use kinds, only: wp
   use quad_jet, only: qp, pi_q
   use mechanism, only: mechanism_t, pair_revolute
   use jet_closure, only: closure_slopes, numbers_of, at_rest
   use quad_matrices, only: spectral_radius, solve_quad
   implicit none
   private
   public :: references_t, printed_references, nearest_references, dyad_references, frozen_matrix, theory

   integer, parameter :: slot_as_printed = 1   !< as (16) has it: columns of x and y alone
   !> of d_x n_x and d_y n_y the one whose n is nearer to zero becomes d s(h) h
   integer, parameter :: slot_one_product = 2

   !> Where the angles that multiply the frozen coefficients are counted from: the cosine's row, the sine's row.
   type :: references_t
      real(qp), allocatable :: body_vectors(:, :)      !< (2, points)
      real(qp), allocatable :: normals(:, :)   !< (2, pairs) of the guides' normals
      integer :: slot = slot_one_product       !< the form of the slot rows
   end type references_t

contains

   !> The print's own choice, (15) and (16): every angle is counted from the x axis, the slot rows as printed.
   pure type(references_t) function printed_references(m) result(z)
      type(mechanism_t), intent(in) :: m

      allocate (z%body_vectors(2, size(m%points)), z%normals(2, size(m%pairs)), source=0.0_qp)
      z%slot = slot_as_printed
   end function printed_references

   !> The zeros of the cosine and the sine nearest to where `q` (3, links) has the arms and normals.
   pure type(references_t) function nearest_references(m, q) result(z)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      integer :: i

      allocate (z%body_vectors(2, size(m%points)), z%normals(2, size(m%pairs)))
      do i = 1, size(m%points)
         z%body_vectors(:, i) = nearest_zeros(body_vector_angle(m, q, i))
      end do
      do i = 1, size(m%pairs)
         z%normals(:, i) = nearest_zeros(normal_angle(m, q, i))
      end do
   end function nearest_references

   !> One reference for each of the two links of a dyad, with which G is nilpotent where they stand in `q` (3, links):
   !> h3 = sec d - tan d and h4 = sec d + tan d, d = phi_4 - phi_3, make (h4 - h3) cot d = 2 and h3 h4 = 1. There are
   !> none at d = 90 deg. `three`, `four`: the links, whose points have eta = 0.
   pure type(references_t) function dyad_references(m, q, three, four) result(z)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      integer, intent(in) :: three, four
      real(qp) :: d

      z = printed_references(m)
      d = q(3, four) - q(3, three)
      call count_from(m, three, q(3, three) - (1.0_qp - sin(d))/cos(d), z)
      call count_from(m, four, q(3, four) - (1.0_qp + sin(d))/cos(d), z)
   end function dyad_references

   !> Both rows of every point of `link` are counted from `angle`.
   pure subroutine count_from(m, link, angle, z)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link
      real(qp), intent(in) :: angle
      type(references_t), intent(inout) :: z
      integer :: i

      do i = 1, size(m%points)
         if (m%points(i)%link == link) z%body_vectors(:, i) = angle
      end do
   end subroutine count_from

   pure function nearest_zeros(psi) result(z)
      real(qp), intent(in) :: psi
      real(qp) :: z(2)

      z = pi_q*[anint(psi/pi_q - 0.5_qp) + 0.5_qp, anint(psi/pi_q)]
   end function nearest_zeros

   !> A of (20), rows and columns in the program's order; the drives are of the kind ANGLE.
   pure function frozen_matrix(m, q, z) result(a)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      type(references_t), intent(in) :: z
      real(qp) :: a(2*size(m%pairs) + size(m%drives), 3*count(.not. m%links%ground))
      real(qp) :: g(3), p(2), w(2)
      integer :: k

      a = 0.0_qp
      do k = 1, size(m%pairs)
         associate (pair => m%pairs(k))
            associate (i => m%points(pair%point_i)%link, j => m%points(pair%point_j)%link)
               p = slope(m, q, z, pair%point_i)
               w = slope(m, q, z, pair%point_j)
               if (pair%kind == pair_revolute) then
                  call put(m, a(2*k - 1, :), i, [1.0_qp, 0.0_qp, p(1)])
                  call put(m, a(2*k, :), i, [0.0_qp, 1.0_qp, p(2)])
                  call put(m, a(2*k - 1, :), j, -[1.0_qp, 0.0_qp, w(1)])
                  call put(m, a(2*k, :), j, -[0.0_qp, 1.0_qp, w(2)])
               else
                  g = slot(m, q, z, k)
                  call put(m, a(2*k - 1, :), i, [g(1), g(2), g(3) + dot_product(g(:2), p)])
                  call put(m, a(2*k - 1, :), j, -[g(1), g(2), dot_product(g(:2), w)])
                  call put(m, a(2*k, :), i, [0.0_qp, 0.0_qp, -1.0_qp])
                  call put(m, a(2*k, :), j, [0.0_qp, 0.0_qp, 1.0_qp])
               end if
            end associate
         end associate
      end do
      do k = 1, size(m%drives)
         call put(m, a(2*size(m%pairs) + k, :), m%drives(k)%subject, [0.0_qp, 0.0_qp, 1.0_qp])
      end do
   end function frozen_matrix

   pure subroutine put(m, row, link, three)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(inout) :: row(:)
      integer, intent(in) :: link
      real(qp), intent(in) :: three(3)
      integer :: c

      if (m%links(link)%ground) return
      c = 3*count(.not. m%links(:link - 1)%ground)
      row(c + 1:c + 3) = row(c + 1:c + 3) + three
   end subroutine put

   !> a cos(psi)/(psi - z), a sin(psi)/(psi - z) of the arm to point `i`.
   pure function slope(m, q, z, i) result(s)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      type(references_t), intent(in) :: z
      integer, intent(in) :: i
      real(qp) :: s(2), psi

      psi = body_vector_angle(m, q, i)
      s = 0.0_qp
      ! The angle of a crank is known, so that its coefficients are not needed.
      if (any(m%drives%subject == m%points(i)%link)) return
      if (all(abs(m%points(i)%offset) <= 0.0_wp)) return
      s = norm2(real(m%points(i)%offset, qp))*[frozen(cos(psi), psi - z%body_vectors(1, i), -sin(psi)), &
         frozen(sin(psi), psi - z%body_vectors(2, i), cos(psi))]
   end function slope

   !> value/h, or its limit at a zero of `value`. Elsewhere h = 0 has no coefficient: c(0) of the print is infinite, and
   !> the number given makes the matrix singular.
   pure real(qp) function frozen(value, h, limit)
      real(qp), intent(in) :: value, h, limit
      real(qp), parameter :: rounding = 1.0e-12_qp, infinite = 1.0e30_qp

      if (abs(h) > rounding) then
         frozen = value/h
      else
         frozen = limit
         if (abs(value) > 2.0_qp*rounding) frozen = infinite
      end if
   end function frozen

   !> Coefficients of d_x, d_y and the guide's angle in the slot row d . n = h.
   pure function slot(m, q, z, k) result(g)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      type(references_t), intent(in) :: z
      integer, intent(in) :: k
      real(qp) :: g(3), psi
      complex(qp) :: d

      psi = normal_angle(m, q, k)
      d = place(m, q, m%pairs(k)%point_i) - place(m, q, m%pairs(k)%point_j)
      if (z%slot == slot_as_printed) then
         g = [cos(psi), sin(psi), 0.0_qp]
      else if (abs(sin(psi)) <= abs(cos(psi))) then
         g = [cos(psi), 0.0_qp, aimag(d)*frozen(sin(psi), psi - z%normals(2, k), cos(psi))]
      else
         g = [0.0_qp, sin(psi), real(d, qp)*frozen(cos(psi), psi - z%normals(1, k), -sin(psi))]
      end if
   end function slot

   pure complex(qp) function place(m, q, i)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      integer, intent(in) :: i

      associate (link => m%points(i)%link, u => real(m%points(i)%offset, qp))
         place = cmplx(q(1, link), q(2, link), qp) + cmplx(u(1), u(2), qp)*exp(cmplx(0.0_qp, q(3, link), qp))
      end associate
   end function place

   pure real(qp) function body_vector_angle(m, q, i)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      integer, intent(in) :: i

      associate (u => real(m%points(i)%offset, qp))
         body_vector_angle = q(3, m%points(i)%link) + atan2(u(2), u(1))
      end associate
   end function body_vector_angle

   pure real(qp) function normal_angle(m, q, k)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      integer, intent(in) :: k

      normal_angle = q(3, m%points(m%pairs(k)%point_i)%link) + real(m%pairs(k)%alpha, qp) + 0.5_qp*pi_q
   end function normal_angle

   !> The spectral radius of G at the solution `q` (3, links); -1.0 where A is singular.
   real(qp) function theory(m, q, z) result(rho)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      type(references_t), intent(in) :: z
      real(qp), allocatable :: a(:, :), g(:, :)
      logical :: singular

      a = frozen_matrix(m, q, z)
      g = a - closure_slopes(m, numbers_of(m), at_rest(q))
      call solve_quad(a, g, singular)
      rho = -1.0_qp
      if (.not. singular) rho = spectral_radius(g)
   end function theory
end module quad_frozen
