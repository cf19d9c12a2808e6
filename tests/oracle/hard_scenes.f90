!> Tests. The scenes of `make hard`: a mechanism, the instants at which it is asked, and where its links are then by a
!> closed form in real128. Those that are built here have their closed forms of the very doubles in them.
module hard_scenes
   use kinds, only: wp
   use plane_vectors, only: degree
   use quad_jet, only: qp, jet_t, operator(+)
   use mechanism, only: mechanism_t, request_t, request_link, instant, instant_count
   use test_counter, only: deck_name, sets_of
   use jet_drives, only: drive_jet
   use closed_forms_dyads, only: place_t, body_t, origin, fixed_place, polar, corner, bars, direction, slider_crank, &
      flat
   use closed_forms, only: closed_form
   use expected_links, only: sort_links
   use sample_mechanisms, only: four_bar, crank_slider, magnified
   implicit none
   private
   public :: scene_t, deck_scenes, jumps_of, far_from, four_bar_scene, slider_scene, exact_links

   integer, parameter :: by_deck = 1, by_four_bar = 2, by_slider = 3

   type :: scene_t
      character(:), allocatable :: name
      type(mechanism_t) :: m
      real(wp), allocatable :: at(:)             !< instants
      integer :: form = by_deck
      character(:), allocatable :: deck          !< base name
      integer :: set = 1
      real(wp) :: far(2) = 0.0_wp                !< by how much all ground stands elsewhere than in the deck
   end type scene_t

contains

   !> All sets of the deck `path` at the deck's own instants, at most `most` of them.
   function deck_scenes(path, most) result(list)
      character(*), intent(in) :: path
      integer, intent(in) :: most
      type(scene_t), allocatable :: list(:)
      type(mechanism_t), allocatable :: sets(:)
      integer :: i, k, every

      sets = sets_of(path)
      allocate (list(size(sets)))
      do i = 1, size(sets)
         associate (s => list(i))
            s%deck = deck_name(path)
            s%set = i
            s%name = s%deck//' '//achar(iachar('0') + i)
            s%m = sets(i)
            s%m%requests = [(request_t(request_link, k, 1), k=1, size(s%m%links))]
            every = max(1, (instant_count(s%m) + most - 1)/most)
            s%at = [(instant(s%m, k), k=0, instant_count(s%m) - 1, every)]
         end associate
      end do
   end function deck_scenes

   !> The scene `s`, whose first drive turns evenly, in steps of 30 degrees and then in leaps forwards, backwards and
   !> over many turns.
   function jumps_of(s) result(j)
      type(scene_t), intent(in) :: s
      type(scene_t) :: j
      real(wp) :: step
      integer :: k
      integer, parameter :: branch_jumps(8) = [25, 7, -3, -370, 1207, 1201, 0, 12000]

      j = s
      j%name = s%name//' LEAPS'
      step = 30.0_wp*degree/abs(s%m%drives(1)%polynomial(2))
      j%at = [(k*step, k=0, 12), branch_jumps*step]
   end function jumps_of

   !> The scene `s` a thousand kilometres away.
   function far_from(s) result(f)
      type(scene_t), intent(in) :: s
      type(scene_t) :: f
      integer :: i

      f = s
      f%name = s%name//' FAR AWAY'
      f%far = [2.0_wp**20, -2.0_wp**19]
      do i = 1, size(f%m%links)
         f%m%links(i)%position(:2) = f%m%links(i)%position(:2) + f%far
      end do
   end function far_from

   !> Base, crank, coupler and rocker of these lengths, open; link `driven` (2: crank, 4: rocker) moves as phi = `law`.
   function four_bar_scene(name, lengths, driven, law, at) result(s)
      character(*), intent(in) :: name
      real(wp), intent(in) :: lengths(4), law(3), at(:)
      integer, intent(in) :: driven
      type(scene_t) :: s

      s%name = name
      s%form = by_four_bar
      s%m = four_bar()
      s%m%points(2)%offset(1) = lengths(1)
      s%m%points(4)%offset(1) = lengths(2)
      s%m%points(6)%offset(1) = lengths(3)
      s%m%points(8)%offset(1) = lengths(4)
      s%m%drives(1)%subject = driven
      s%m%drives(1)%polynomial = law
      s%at = at
      call place_roughly(s)
   end function four_bar_scene

   !> Crank 1, rod 3 on a line at 0.5, times `size`; the crank moves as phi = `law`.
   function slider_scene(name, size_of_it, law, at) result(s)
      character(*), intent(in) :: name
      real(wp), intent(in) :: size_of_it, law(3), at(:)
      type(scene_t) :: s

      s%name = name
      s%form = by_slider
      s%m = magnified(crank_slider(0.5_wp), size_of_it)
      s%m%drives(1)%polynomial = law
      s%at = at
      call place_roughly(s)
   end function slider_scene

   !> The links of `s` at `t` in the order of its mechanism.
   function exact_links(s, t) result(b)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: t
      type(body_t) :: b(size(s%m%links))
      type(body_t), allocatable :: form(:)
      character(:), allocatable :: fault

      select case (s%form)
      case (by_deck)
         form = closed_form(s%deck, s%set, real(t, qp))
      case (by_four_bar)
         form = four_bar_form(s%m, drive_jet(s%m%drives(1), real(t, qp)))
      case default
         form = slider_form(s%m, drive_jet(s%m%drives(1), real(t, qp)))
      end select
      call sort_links(s%m, form, b, fault)
      if (fault /= '') error stop 'A SCENE WITHOUT A CLOSED FORM'
      b%x = b%x + real(s%far(1), qp)
      b%y = b%y + real(s%far(2), qp)
   end function exact_links

   !> The links of the four-bar `m` with its driven link at `phi`.
   function four_bar_form(m, phi) result(links)
      type(mechanism_t), intent(in) :: m
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)
      type(place_t) :: b0, a, b
      real(qp) :: r(4)

      r = [m%points(2)%offset(1), m%points(4)%offset(1), m%points(6)%offset(1), m%points(8)%offset(1)]
      b0 = fixed_place(r(1), 0.0_qp)
      if (m%drives(1)%subject == 2) then
         a = polar(origin, r(2), phi)
         links = bars(phi, a, corner(a, r(3), b0, r(4), 1.0_qp), b0)
      else
         b = polar(b0, r(4), phi)
         a = corner(origin, r(2), b, r(3), 1.0_qp)
         links = bars(direction(origin, a), a, b, b0)
      end if
      links(m%drives(1)%subject)%phi = phi
   end function four_bar_form

   !> The links of the slider-crank `m` with its crank at `phi`.
   function slider_form(m, phi) result(links)
      type(mechanism_t), intent(in) :: m
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)

      links = slider_crank(phi, [real(m%points(4)%offset(1), qp), real(m%points(6)%offset(1), qp)], &
         fixed_place(0.0_qp, real(m%points(2)%offset(2), qp)), flat)
   end function slider_form

   !> The deck's rough positions: the exact ones at the first instant, but for a thousandth.
   subroutine place_roughly(s)
      type(scene_t), intent(inout) :: s
      type(body_t) :: b(size(s%m%links))
      integer :: i

      b = exact_links(s, s%at(1))
      do i = 1, size(b)
         if (s%m%links(i)%ground) cycle
         s%m%links(i)%position = real([1.001_qp*b(i)%x%v, 1.001_qp*b(i)%y%v, b(i)%phi%v + 0.001_qp], wp)
      end do
   end subroutine place_roughly
end module hard_scenes
